// SPDX-License-Identifier: Apache-2.0
// The linear variance equation along a path (thesis 4.2 to 4.8 with dt counted once).
#include "slipwise/segment/segment_covariance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>
#include <vector>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

/// How steps move what sensors see, one after the other. The heading's rotation is carried along, so that a step costs
/// the trigonometry of its turn alone.
template <int kRows>
class RowsBySteps {
 public:
  static constexpr int kMost = kRows == Eigen::Dynamic ? kMostRows : kRows;
  using ByTangent = Eigen::Matrix<double, kRows, 3, Eigen::ColMajor, kMost, 3>;
  using Covariance = Eigen::Matrix<double, kRows, kRows, Eigen::ColMajor, kMost, kMost>;

  explicit RowsBySteps(const SegmentPath& path) : path_(path) {
    const std::vector<Seen> seen = path.seen();
    for (const Seen& each : seen) {
      rows_ += each.z.size();
    }
    ahead_.setZero(rows_, 3);
    levers_.setZero(rows_, 1);
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      for (std::size_t i = 0; std::cmp_less(i, path.sights[k].stamps.size()); ++i) {
        looked_.push_back({path.sights[k].at[i], row, seen[k].by_pose[i]});
        pass(looked_.back(), 1.0);
      }
      row += seen[k].z.size();
    }
    std::ranges::stable_sort(looked_, {}, &Looked::place);
  }

  Eigen::Index rows() const { return rows_; }

  /// Derivative by the tangent of the next step: the sum of each later pose's, times how that follows from the pose
  /// after the step.
  ByTangent by_next_tangent() {
    const Eigen::Vector3d& tangent = path_.tangents[next_];
    const auto arc = arc_functions(tangent.z());
    Eigen::Matrix3d world = chart_jacobian(tangent, arc);  // blkdiag(R, 1) E
    world.topRows<2>() = (heading_ * world.topRows<2>()).eval();
    const Eigen::Vector2d ahead = heading_ * Eigen::Vector2d(arc.cos_turn, arc.sin_turn);
    heading_ << ahead.x(), -ahead.y(), ahead.y(), ahead.x();
    ++next_;
    for (; passed_ < looked_.size() && looked_[passed_].place < next_; ++passed_) {
      pass(looked_[passed_], -1.0);
    }
    const Pose2& here = path_.poses[next_];
    ByTangent by_here = ahead_;
    by_here.col(2) += levers_ - ahead_.template leftCols<2>() * Eigen::Vector2d(-here.y, here.x);
    return by_here * world;
  }

 private:
  /// A pose that a sensor looks at, and where its rows begin.
  struct Looked {
    std::size_t place;
    Eigen::Index row;
    RowsByPose by_pose;
  };

  void pass(const Looked& each, double sign) {
    const Pose2& pose = path_.poses[each.place];
    ahead_.middleRows(each.row, each.by_pose.rows()) += sign * each.by_pose;
    levers_.middleRows(each.row, each.by_pose.rows()) +=
        sign * each.by_pose.template leftCols<2>() * Eigen::Vector2d(-pose.y, pose.x);
  }

  const SegmentPath& path_;
  std::vector<Looked> looked_;
  Eigen::Index rows_ = 0;
  std::size_t next_ = 0;
  std::size_t passed_ = 0;
  ByTangent ahead_;                                                    ///< by poses that are still ahead, summed
  Eigen::Matrix<double, kRows, 1, Eigen::ColMajor, kMost, 1> levers_;  ///< what their places add to it by a turn
  Eigen::Matrix2d heading_ = Eigen::Matrix2d::Identity();
};

std::array<double, 3> motion_of(const ActuatorStep& step) {
  const double distance = std::hypot(step.forward, step.left);
  const double turn = std::abs(step.turn);
  const double wheels = distance + kTurnRadius * turn;
  return {wheels, wheels, turn + distance / kStraightRadius};
}

/// Steps with which the pieces of a gyro begin, but for the first.
std::vector<std::size_t> begun_pieces(const SegmentPath& path) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < path.sights.size(); ++i) {
    const bool gyro = std::holds_alternative<YawRateSensor>(path.measured[i].sensor.kind);
    for (std::size_t k = 1; gyro && std::cmp_less(k + 1, path.sights[i].stamps.size()); ++k) {
      found.push_back(path.sights[i].at[k]);
    }
  }
  return found;
}

/// Sums over the steps; `kRows` are three where one sensor sees all three, so that most segments cost no loops.
template <int kRows>
RowsCovariance summed_covariance(const SegmentPath& path, const MotionNoise& noise) {
  RowsBySteps<kRows> seen(path);
  using Square = RowsBySteps<kRows>::Covariance;
  using ByTangent = RowsBySteps<kRows>::ByTangent;
  Square covariance = Square::Zero(seen.rows(), seen.rows());
  ByTangent constant = ByTangent::Zero(seen.rows(), 3);  // column c: of a slip that is the same fraction all along
  const std::vector<std::size_t> pieces = begun_pieces(path);  // from one to the next, where turns of each are measured
  auto piece = pieces.begin();
  for (std::size_t k = 0; k < path.tangents.size(); ++k) {
    for (; piece != pieces.end() && *piece == k; ++piece) {
      covariance += constant * constant.transpose();
      constant.setZero();
    }
    const ByTangent by_tangent = seen.by_next_tangent();
    const std::array<double, 3> motion = motion_of(path.drive[k]);
    const double moving_time = motion[0] > 0.0 ? path.drive[k].duration : 0.0;
    for (Eigen::Index c = 0; c < 3; ++c) {
      const auto i = static_cast<std::size_t>(c);
      const double variance = noise.psd_time[i] * moving_time + noise.psd_motion[i] * motion[i];
      covariance += variance * by_tangent.col(c) * by_tangent.col(c).transpose();
      constant.col(c) += by_tangent.col(c) * (noise.fraction[i] * motion[i]);
    }
  }
  covariance += constant * constant.transpose();
  return covariance;
}

bool one_sensor_of_three_rows(const SegmentPath& path) {
  return path.measured.size() == 1 && path.measured.front().z.size() == 3;
}

}  // namespace

RowsCovariance slip_covariance(const SegmentPath& path, const MotionNoise& noise) {
  return one_sensor_of_three_rows(path) ? summed_covariance<3>(path, noise)
                                        : summed_covariance<Eigen::Dynamic>(path, noise);
}

Eigen::Matrix3d constant_slip(const SegmentPath& path, const MotionNoise& noise) {
  RowsBySteps<3> seen(path);
  Eigen::Matrix3d constant = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < path.tangents.size(); ++k) {
    const Eigen::Matrix3d by_tangent = seen.by_next_tangent();
    const std::array<double, 3> motion = motion_of(path.drive[k]);
    for (Eigen::Index c = 0; c < 3; ++c) {
      const auto i = static_cast<std::size_t>(c);
      constant.col(c) += by_tangent.col(c) * (noise.fraction[i] * motion[i]);
    }
  }
  return constant;
}

RowsCovariance shared_noise(const Segment& segment, const Segment& before, const MotionNoise& noise,
                            const Eigen::Vector3d& scale) {
  const auto& [sensor, z] = segment.measured.front();
  const auto& [other, seen] = before.measured.front();
  const auto* pose = std::get_if<PoseSensor>(&sensor.kind);
  const bool same = sensor.number == other.number && std::holds_alternative<PoseSensor>(other.kind);
  if (pose == nullptr || !same || !same_stamp(segment.start, before.end)) {
    return {};
  }
  RowsCovariance shared = RowsCovariance::Zero(rows_of(segment.measured).size(), rows_of(before.measured).size());
  const Rows size = noise_factors({segment.measured.front()}, scale)
                        .cwiseProduct(noise_factors({before.measured.front()}, scale))
                        .cwiseSqrt();
  shared.topLeftCorner(3, 3) = scaled_covariance(
      shared_pose_noise(Pose2::from_vector(z), Pose2::from_vector(seen), noise, pose->std_ratio.front()), size);
  return shared;
}

RowsCovariance scaled_covariance(const RowsCovariance& covariance, const Rows& scale) {
  const Rows root = scale.cwiseSqrt();
  return root.asDiagonal() * covariance * root.asDiagonal();
}

Rows scale_for(const SegmentPath& path, const Eigen::Vector3d& scale) {
  return noise_factors(path.measured, scale).cwiseQuotient(noise_factors(path.measured, Eigen::Vector3d::Ones()));
}

RowsCovariance segment_noise(const SegmentPath& path, const Rows& measured, const MotionNoise& noise,
                             const Eigen::Vector3d& scale) {
  return scaled_covariance(slip_covariance(path, noise) + path.measurement_noise(measured, noise),
                           noise_factors(path.measured, scale));
}

RowsCovariance expected_noise(const SegmentPath& path, const Rows& measured, const MotionNoise& noise) {
  return segment_noise(path, measured, noise, Eigen::Vector3d::Ones());
}

}  // namespace slipwise
