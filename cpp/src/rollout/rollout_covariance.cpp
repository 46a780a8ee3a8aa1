// SPDX-License-Identifier: Apache-2.0
// Derivatives along the roots of the parameters' covariance, and the slip noise by prefix sums.
#include "slipwise/rollout/rollout_covariance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "slipwise/linear/symmetric_eigen.hpp"
#include "slipwise/rollout/rollout_threads.hpp"

namespace slipwise {
namespace {

constexpr double kStep = 1e-3;  // of a root of the covariance, for central differences
constexpr std::size_t kEntries = 6;

/// Where the entry (row, column) of a symmetric matrix stands among (xx, xy, yy, xt, yt, tt).
constexpr std::array<std::array<std::size_t, 2>, kEntries> kPlaces{
    {{{0, 0}}, {{0, 1}}, {{1, 1}}, {{0, 2}}, {{1, 2}}, {{2, 2}}}};

/// What the parameters' errors and the slip disturbance do to every pose.
class ParameterPart {
 public:
  ParameterPart(const UncertainModel& model, const RolloutBatch<double>& batch, const RolloutOptions& options,
                std::span<double> out)
      : model_(model), batch_(batch), options_(options), out_(out) {}

  void add_learned() {
    const Eigen::MatrixXd root = covariance_root(model_.uncertainty.covariance);
    const std::vector<double> once(batch_.periods, 1.0);
    for (Eigen::Index j = 0; j < root.cols(); ++j) {
      if (!root.col(j).isZero(0.0)) {
        add_direction(root.col(j), {}, once);
      }
    }
    for (const Eigen::MatrixXd& direction : model_.uncertainty.ahead) {
      add_direction(Eigen::VectorXd::Zero(model_.parameters.size()), direction, once);
    }
  }

  /// The slip disturbance acts on the pose after some time as its mean over that time does.
  void add_disturbance() {
    const DisturbedTerms terms = disturbed_terms_of(model_);
    for (Eigen::Index i = 0; i < terms.size(); ++i) {
      const double prior_std = terms.prior_std[i];
      std::vector<double> variances;  // in units of the prior's
      for (std::size_t k = 1; k <= batch_.periods && prior_std > 0.0; ++k) {
        const double seconds = static_cast<double>(k) * model_.setting.period;
        variances.push_back(nominal_variances(model_.uncertainty.disturbance, terms, seconds)[i] /
                            (prior_std * prior_std));
      }
      if (!variances.empty() && variances.front() > 0.0) {
        const Eigen::Index place = terms.places[static_cast<std::size_t>(i)];
        add_direction(prior_std * Eigen::VectorXd::Unit(model_.parameters.size(), place), {}, variances);
      }
    }
  }

 private:
  /// Adds d d^T, times a variance per period, for the derivative d of every pose along one direction of the parameters
  /// and of the slip ahead: central differences of two rollouts.
  void add_direction(const Eigen::VectorXd& direction, const Eigen::MatrixXd& of_slip,
                     std::span<const double> variances) {
    const RolloutPaths ahead = along(kStep * direction, kStep * of_slip);
    const RolloutPaths behind = along(-kStep * direction, -kStep * of_slip);
    const std::size_t poses = ahead.x.size();
    for (std::size_t i = 0; i < poses; ++i) {
      const std::array<double, 3> d{(ahead.x[i] - behind.x[i]) / (2.0 * kStep),
                                    (ahead.y[i] - behind.y[i]) / (2.0 * kStep),
                                    (ahead.theta[i] - behind.theta[i]) / (2.0 * kStep)};
      for (std::size_t e = 0; e < kEntries; ++e) {
        out_[e * poses + i] += variances[i / batch_.rollouts] * d[kPlaces[e][0]] * d[kPlaces[e][1]];
      }
    }
  }

  RolloutPaths along(const Eigen::VectorXd& step, const Eigen::MatrixXd& of_slip) const {
    return roll_paths(moved(model_, model_.parameters + step, of_slip), batch_, options_);
  }

  const UncertainModel& model_;
  const RolloutBatch<double>& batch_;
  const RolloutOptions& options_;
  std::span<double> out_;
};

/// Noise of one rollout as it goes along (derivations/model.md and uncertainty.md): sums carried back to the
/// world's origin.
class NoiseSums {
 public:
  /// One period from `before` to `after`, in which the drive alone moves by `drive`.
  void add(const Pose2& before, const Pose2& after, const PeriodNoise& noise) {
    const Eigen::Vector3d tangent = period_tangent(before, after);
    Eigen::Matrix3d world = chart_jacobian(tangent);
    world.topRows<2>() = (rotation(before.theta) * world.topRows<2>()).eval();
    const Eigen::Matrix3d carried = transition(after, Pose2{}) * world;
    for (Eigen::Index c = 0; c < 3; ++c) {
      const auto i = static_cast<std::size_t>(c);
      white_ += noise.variance[i] * carried.col(c) * carried.col(c).transpose();
      constant_.col(c) += noise.constant[i] * carried.col(c);
    }
  }

  Eigen::Matrix3d at(const Pose2& pose) const {
    const Eigen::Matrix3d phi = transition(Pose2{}, pose);
    return phi * (white_ + constant_ * constant_.transpose()) * phi.transpose();
  }

 private:
  Eigen::Matrix3d white_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d constant_ = Eigen::Matrix3d::Zero();
};

/// D S D in the frame of the start, whose axes the learned factors belong to; returned in the world's.
Eigen::Matrix3d scaled(const Eigen::Matrix3d& world, const Pose2& start, const Eigen::Vector3d& root) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = rotation(start.theta);
  const Eigen::Matrix3d by = turn * root.asDiagonal() * turn.transpose();
  return by * world * by;
}

}  // namespace

void rollout_covariance(const UncertainModel& model, const RolloutBatch<double>& batch, std::span<double> out,
                        const RolloutOptions& options) {
  check_uncertainty(model);
  const std::size_t poses = batch.rollouts * batch.periods;
  if (out.size() != kEntries * poses) {
    throw std::invalid_argument("the covariances of " + std::to_string(poses) + " poses are " +
                                std::to_string(kEntries * poses) + " numbers, got room for " +
                                std::to_string(out.size()));
  }
  const RolloutPaths paths = roll_paths({model.model, model.parameters, model.setting}, batch, options);
  const RolloutPaths drive = roll_paths(drive_alone(model), batch, options);
  std::ranges::fill(out, 0.0);
  ParameterPart fraction(model, batch, options, out);
  fraction.add_learned();
  fraction.add_disturbance();
  const Eigen::Vector3d root = model.uncertainty.scale.cwiseSqrt();
  share_out(batch.rollouts, options.threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t n = first; n < last; ++n) {
      const Pose2 start = batch.starts[batch.starts.size() > 1 ? n : 0].pose;
      NoiseSums sums;
      Pose2 before = start;
      Pose2 driven = start;
      for (std::size_t k = 0; k < batch.periods; ++k) {
        const Eigen::Vector3d moved = period_tangent(driven, drive.at(k, n));
        sums.add(before, paths.at(k, n), period_noise(moved, model.setting.period, model.uncertainty.noise));
        before = paths.at(k, n);
        driven = drive.at(k, n);
        const Eigen::Matrix3d noise = scaled(sums.at(before), start, root);
        for (std::size_t e = 0; e < kEntries; ++e) {
          double& entry = out[e * poses + k * batch.rollouts + n];
          entry = model.uncertainty.inflation *
                  (entry + noise(static_cast<Eigen::Index>(kPlaces[e][0]), static_cast<Eigen::Index>(kPlaces[e][1])));
        }
      }
    }
  });
}

}  // namespace slipwise
