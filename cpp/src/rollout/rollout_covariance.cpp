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
constexpr std::size_t kTogether = 8;  // rollouts whose numbers share a line of the processor's cache

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
    constexpr double kPerStep = 1.0 / (2.0 * kStep);
    for (std::size_t k = 0; k < batch_.periods; ++k) {
      for (std::size_t i = k * batch_.rollouts; i < (k + 1) * batch_.rollouts; ++i) {
        const double x = kPerStep * (ahead.x[i] - behind.x[i]), y = kPerStep * (ahead.y[i] - behind.y[i]),
                     turn = kPerStep * (ahead.theta[i] - behind.theta[i]);
        out_[i] += variances[k] * x * x;
        out_[poses + i] += variances[k] * x * y;
        out_[2 * poses + i] += variances[k] * y * y;
        out_[3 * poses + i] += variances[k] * x * turn;
        out_[4 * poses + i] += variances[k] * y * turn;
        out_[5 * poses + i] += variances[k] * turn * turn;
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

/// How far the drive moves over a period: along its arc, and turning.
Eigen::Vector3d driven_length(const Pose2& before, const Pose2& after) {
  const double turn = after.theta - before.theta;
  const auto arc = arc_functions(turn);
  return {std::hypot(after.x - before.x, after.y - before.y) / std::hypot(arc.a, arc.b), 0.0, turn};
}

/// Noise of one rollout as it goes along (derivations/model.md and uncertainty.md): sums carried back to the
/// world's origin. The learned factors belong to the axes of the start: D S D there, returned in the world's.
class NoiseSums {
 public:
  NoiseSums(const Pose2& start, const Eigen::Vector3d& root) {
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    turn.topLeftCorner<2, 2>() = rotation(start.theta);
    by_ = turn * root.asDiagonal() * turn.transpose();
  }

  /// One period from `before` to `after`.
  void add(const Pose2& before, const Pose2& after, const PeriodNoise& noise) {
    const auto arc = arc_functions(after.theta - before.theta);
    const Eigen::Matrix2d heading = rotation(before.theta);
    const Eigen::Vector2d moved = heading.transpose() * Eigen::Vector2d(after.x - before.x, after.y - before.y);
    const double scale = 1.0 / (arc.a * arc.a + arc.b * arc.b);
    const Eigen::Vector3d tangent(scale * (arc.a * moved.x() + arc.b * moved.y()),
                                  scale * (arc.a * moved.y() - arc.b * moved.x()), after.theta - before.theta);
    Eigen::Matrix3d carried = chart_jacobian(tangent, arc);
    carried.topRows<2>() = (heading * carried.topRows<2>()).eval();
    carried(0, 2) += after.y;
    carried(1, 2) -= after.x;
    for (Eigen::Index c = 0; c < 3; ++c) {
      const auto i = static_cast<std::size_t>(c);
      white_ += noise.variance[i] * carried.col(c) * carried.col(c).transpose();
      constant_.col(c) += noise.constant[i] * carried.col(c);
    }
  }

  Eigen::Matrix3d at(const Pose2& pose) const {
    const Eigen::Matrix3d onto = by_ * transition(Pose2{}, pose);
    const Eigen::Matrix3d all = white_ + constant_ * constant_.transpose();
    return onto * all * onto.transpose();
  }

 private:
  Eigen::Matrix3d white_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d constant_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d by_;
};

/// Adds the noise of a pose to its entries, of which each stands `poses` numbers after the one before; all grow by the
/// inflation.
void add_noise(double inflation, const Eigen::Matrix3d& noise, std::span<double> entries, std::size_t poses) {
  for (std::size_t e = 0; e < kEntries; ++e) {
    const auto row = static_cast<Eigen::Index>(kPlaces[e][0]), column = static_cast<Eigen::Index>(kPlaces[e][1]);
    entries[e * poses] = inflation * (entries[e * poses] + noise(row, column));
  }
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
  const auto start_of = [&](std::size_t n) { return batch.starts[batch.starts.size() > 1 ? n : 0].pose; };
  share_out((batch.rollouts + kTogether - 1) / kTogether, options.threads, [&](std::size_t block, std::size_t end) {
    for (; block < end; ++block) {
      const std::size_t first = block * kTogether, last = std::min(first + kTogether, batch.rollouts);
      std::vector<NoiseSums> sums;
      for (std::size_t n = first; n < last; ++n) {
        sums.emplace_back(start_of(n), root);
      }
      for (std::size_t k = 0; k < batch.periods; ++k) {
        for (std::size_t n = first; n < last; ++n) {
          const Pose2 before = k == 0 ? start_of(n) : paths.at(k - 1, n), after = paths.at(k, n);
          const Eigen::Vector3d moved = driven_length(k == 0 ? start_of(n) : drive.at(k - 1, n), drive.at(k, n));
          NoiseSums& sum = sums[n - first];
          sum.add(before, after, period_noise(moved, model.setting.period, model.uncertainty.noise));
          add_noise(model.uncertainty.inflation, sum.at(after), out.subspan(k * batch.rollouts + n), poses);
        }
      }
    }
  });
}

}  // namespace slipwise
