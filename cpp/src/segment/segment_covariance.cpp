// SPDX-License-Identifier: Apache-2.0
// The linear variance equation along a path (thesis 4.2 to 4.8 with dt counted once).
#include "slipwise/segment/segment_covariance.hpp"

#include <cmath>

#include "slipwise/linear/present.hpp"
#include "slipwise/segment/sensor_motion.hpp"

namespace slipwise {
namespace {

/// How steps move the chart that a segment's measurement is compared with, one after the other. The heading's rotation
/// is carried along, so that a step costs the trigonometry of its turn alone.
class ChartBySteps {
 public:
  explicit ChartBySteps(const SegmentPath& path) : path_(path) {
    if (path.course) {
      by_position_ = course_by_position(path.course_positions(), *path.course);
      for (std::size_t i = 0; i < kCoursePoints; ++i) {
        by_robot_[i] = sensor_by_robot(path.poses[path.course->at[i]], path.sensor);
      }
    }
  }

  /// Derivative by the tangent of the next step: of the robot's chart at the end, or between positions of the course's.
  Eigen::Matrix3d by_next_tangent() {
    const Eigen::Vector3d& tangent = path_.tangents[next_];
    const auto arc = arc_functions(tangent.z());
    Eigen::Matrix3d world = chart_jacobian(tangent, arc);  // blkdiag(R, 1) E
    world.topRows<2>() = (heading_ * world.topRows<2>()).eval();
    const Eigen::Vector2d ahead = heading_ * Eigen::Vector2d(arc.cos_turn, arc.sin_turn);
    heading_ << ahead.x(), -ahead.y(), ahead.y(), ahead.x();
    ++next_;
    return path_.course ? course_by_world(world) : transition(path_.poses[next_], path_.poses.back()) * world;
  }
  /// What leads from there to the chart of the measurement.
  Eigen::Matrix3d observed() const {
    return path_.course ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                        : sensor_by_robot(path_.poses.back(), path_.sensor);
  }

 private:
  Eigen::Matrix3d course_by_world(const Eigen::Matrix3d& world) const {
    const CoursePlaces& course = present(path_.course);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < kCoursePoints; ++i) {
      const std::size_t place = course.at[i];
      if (place >= next_) {
        const Pose2& pose = path_.poses[place];
        const Eigen::Matrix3d moved = by_robot_[i] * transition(path_.poses[next_], pose) * world;
        sum += by_position_[i] * moved.topRows<2>();
        if (course.gyro_std && (i == kStart || i == kEnd)) {
          sum.row(2) += (i == kEnd ? 1.0 : -1.0) * moved.row(2);
        }
      }
    }
    return sum;
  }

  const SegmentPath& path_;
  ByPosition by_position_;
  std::array<Eigen::Matrix3d, kCoursePoints> by_robot_;  ///< of the sensor's positions at the course's points
  std::size_t next_ = 0;
  Eigen::Matrix2d heading_ = Eigen::Matrix2d::Identity();
};

/// H of derivations/uncertainty.md: a start measured too far left and turned too far left moves the end right and back.
Eigen::Matrix3d end_by_start(const Pose2& measured) {
  Eigen::Matrix3d by_start = -Eigen::Matrix3d::Identity();
  by_start(0, 2) = measured.y;
  by_start(1, 2) = -measured.x;
  return by_start;
}

Eigen::Matrix3d pose_covariance(const MotionNoise& noise, const PoseStdRatio& ratio) {
  const double xy = ratio.xy * noise.pose_std_xy;
  const double yaw = ratio.yaw * noise.pose_std_yaw;
  return Eigen::Vector3d(xy * xy, xy * xy, yaw * yaw).asDiagonal();
}

std::array<double, 3> motion_of(const ActuatorStep& step) {
  const double distance = std::hypot(step.forward, step.left);
  const double turn = std::abs(step.turn);
  const double wheels = distance + kTurnRadius * turn;
  return {wheels, wheels, turn + distance / kStraightRadius};
}

}  // namespace

Eigen::Matrix3d slip_covariance(const SegmentPath& path, const MotionNoise& noise) {
  ChartBySteps chart(path);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d constant = Eigen::Matrix3d::Zero();  // column c: effect of a slip that is the same fraction all along
  for (std::size_t k = 0; k < path.tangents.size(); ++k) {
    const Eigen::Matrix3d by_tangent = chart.by_next_tangent();
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
  const Eigen::Matrix3d observed = chart.observed();
  return observed * covariance * observed.transpose();
}

Eigen::Matrix3d constant_slip(const SegmentPath& path, const MotionNoise& noise) {
  ChartBySteps chart(path);
  Eigen::Matrix3d constant = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < path.tangents.size(); ++k) {
    const Eigen::Matrix3d by_tangent = chart.by_next_tangent();
    const std::array<double, 3> motion = motion_of(path.drive[k]);
    for (Eigen::Index c = 0; c < 3; ++c) {
      const auto i = static_cast<std::size_t>(c);
      constant.col(c) += by_tangent.col(c) * (noise.fraction[i] * motion[i]);
    }
  }
  return chart.observed() * constant;
}

Eigen::Matrix3d pose_noise_covariance(const Pose2& measured, const MotionNoise& noise,
                                      const std::array<PoseStdRatio, 2>& ratio) {
  const Eigen::Matrix3d from_start = end_by_start(measured);
  return from_start * pose_covariance(noise, ratio[0]) * from_start.transpose() + pose_covariance(noise, ratio[1]);
}

Eigen::Matrix3d pose_noise_covariance(const SegmentPath& path, const Pose2& measured, const MotionNoise& noise) {
  if (!path.course) {
    return pose_noise_covariance(measured, noise, path.pose_std_ratio);
  }
  const auto& at = path.course->at;
  ByPosition by = course_by_position(path.course_positions(), *path.course);
  if (at[kEndChord] == at[kStart]) {  // one position, one error
    by[kStart] += by[kEndChord];
    by[kEndChord].setZero();
  }
  if (at[kEndChord] == at[kStartChord]) {
    by[kStartChord] += by[kEndChord];
    by[kEndChord].setZero();
  }
  // A course is no better a heading than a measured one. Without that, a segment with hardly any motion, whose chords
  // are almost the same, would seem to measure their difference exactly.
  MotionNoise headings = noise;
  headings.pose_std_xy = 0.0;
  Eigen::Matrix3d covariance = pose_noise_covariance(measured, headings, path.pose_std_ratio);
  if (path.course->gyro_std) {  // the turn is the gyro's, whatever the heading at the start
    covariance.row(2).setZero();
    covariance.col(2).setZero();
    covariance(2, 2) = *path.course->gyro_std * *path.course->gyro_std;
  }
  for (std::size_t i = 0; i < kCoursePoints; ++i) {
    const double std = path.pose_std_ratio[i < kEndChord ? 0 : 1].xy * noise.pose_std_xy;
    covariance += std * std * by[i] * by[i].transpose();
  }
  return covariance;
}

Eigen::Matrix3d shared_pose_noise(const Pose2& measured, const Pose2& before, const MotionNoise& noise,
                                  const PoseStdRatio& ratio) {
  Eigen::Matrix3d seen_there = Eigen::Matrix3d::Identity();  // turns back to the frame of the earlier start
  seen_there.topLeftCorner<2, 2>() = rotation(-before.theta);
  return end_by_start(measured) * seen_there * pose_covariance(noise, ratio);
}

Eigen::Matrix3d scaled_covariance(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& scale) {
  const Eigen::Vector3d root = scale.cwiseSqrt();
  return root.asDiagonal() * covariance * root.asDiagonal();
}

Eigen::Matrix3d expected_noise(const SegmentPath& path, const Pose2& measured, const MotionNoise& noise) {
  if (path.heading_std) {  // of the position nothing is measured, and nothing may be learned
    const double turn = slip_covariance(path, noise)(2, 2) + *path.heading_std * *path.heading_std;
    return Eigen::Vector3d(1.0, 1.0, turn).asDiagonal();
  }
  return scaled_covariance(slip_covariance(path, noise) + pose_noise_covariance(path, measured, noise),
                           path.noise_factor);
}

Eigen::Vector3d scale_for(const SegmentPath& path, const Eigen::Vector3d& scale) {
  return path.own_noise ? Eigen::Vector3d(Eigen::Vector3d::Ones()) : scale;
}

Eigen::Matrix3d segment_noise(const SegmentPath& path, const Pose2& measured, const MotionNoise& noise,
                              const Eigen::Vector3d& scale) {
  return scaled_covariance(expected_noise(path, measured, noise), scale_for(path, scale));
}

}  // namespace slipwise
