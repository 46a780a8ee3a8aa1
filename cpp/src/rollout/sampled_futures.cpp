// SPDX-License-Identifier: Apache-2.0
// Drawing parameters, the slip disturbance and slip noise.
#include "slipwise/rollout/sampled_futures.hpp"

#include <array>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "slipwise/linear/symmetric_eigen.hpp"
#include "slipwise/rollout/rollout_threads.hpp"

namespace slipwise {
namespace {

/// A generator for one sample of one rollout: neighbours' numbers do not depend on each other.
std::mt19937_64 generator(std::uint64_t seed, std::uint64_t sample, std::uint64_t rollout) {
  std::uint64_t mixed = seed;
  for (const std::uint64_t part : {sample, rollout}) {  // SplitMix64 (Steele, Lea and Flood 2014)
    mixed += 0x9E3779B97F4A7C15U * (part + 1U);
    mixed = (mixed ^ (mixed >> 30U)) * 0xBF58476D1CE4E5B9U;
    mixed = (mixed ^ (mixed >> 27U)) * 0x94D049BB133111EBU;
    mixed ^= mixed >> 31U;
  }
  return std::mt19937_64(mixed);
}

constexpr std::uint64_t kParameters = ~std::uint64_t{0};  // stands for the rollout where parameters are drawn
constexpr std::uint64_t kSurfaces = kParameters - 1;      // and where the slip of surfaces ahead is

/// An error of the slip ahead, [slip, stretches]; no columns where there is none.
Eigen::MatrixXd draw_ahead(const UncertainModel& model, std::size_t sample, std::uint64_t seed) {
  const std::vector<Eigen::MatrixXd>& directions = model.uncertainty.ahead;
  if (directions.empty()) {
    return {};
  }
  std::mt19937_64 random = generator(seed, sample, kSurfaces);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd drawn = Eigen::MatrixXd::Zero(directions.front().rows(), directions.front().cols());
  for (const Eigen::MatrixXd& direction : directions) {
    drawn += std::sqrt(model.uncertainty.inflation) * normal(random) * direction;
  }
  return drawn;
}

/// What the drive does over a period, and the standard deviations of the noise that comes with it.
struct DrivenPeriod {
  Eigen::Vector3d drive;
  std::array<double, 3> white;
  std::array<double, 3> constant;
};

/// The periods of all rollouts, [periods * rollouts]: the same in every sample.
std::vector<DrivenPeriod> driven_periods(const UncertainModel& model, const RolloutBatch<double>& batch,
                                         const RolloutOptions& options) {
  const RolloutPaths drive = roll_paths(drive_alone(model), batch, options);
  std::vector<DrivenPeriod> periods(batch.periods * batch.rollouts);
  for (std::size_t n = 0; n < batch.rollouts; ++n) {
    Pose2 before = batch.starts[batch.starts.size() > 1 ? n : 0].pose;
    for (std::size_t k = 0; k < batch.periods; ++k) {
      DrivenPeriod& period = periods[k * batch.rollouts + n];
      period.drive = period_tangent(before, drive.at(k, n));
      const PeriodNoise noise = period_noise(period.drive, model.setting.period, model.uncertainty.noise);
      for (std::size_t c = 0; c < noise.variance.size(); ++c) {
        const double widened =
            std::sqrt(model.uncertainty.inflation * model.uncertainty.scale[static_cast<Eigen::Index>(c)]);
        period.white[c] = widened * std::sqrt(noise.variance[c]);
        period.constant[c] = widened * noise.constant[c];
      }
      before = drive.at(k, n);
    }
  }
  return periods;
}

/// Drives along a path again, with noise added to the tangent of every period.
class NoisyPath {
 public:
  NoisyPath(const UncertainModel& model, const DisturbedTerms& terms, std::mt19937_64 random)
      : model_(model), terms_(terms), random_(random) {
    for (double& part : constant_) {
      part = normal_(random_);
    }
    const DisturbanceModel& law = model.uncertainty.disturbance;
    if (terms.size() > 0) {
      std::discrete_distribution<std::size_t> which(law.weights.begin(), law.weights.end());
      const SlipDisturbance& disturbance = law.candidates[which(random_)];
      kept_ = std::exp(-model.setting.period / disturbance.time_constant);
      nominal_ = terms.variances(disturbance).cwiseSqrt();
      deviation_ = nominal_.unaryExpr([&](double std) { return std * normal_(random_); });
    }
  }

  Pose2 next(const Pose2& pose, Eigen::Vector3d tangent, const DrivenPeriod& period) {
    for (std::size_t c = 0; c < constant_.size(); ++c) {
      tangent[static_cast<Eigen::Index>(c)] += period.white[c] * normal_(random_) + period.constant[c] * constant_[c];
    }
    disturbance(tangent, period.drive);
    return compose(pose, exp(tangent));
  }

 private:
  /// Adds the slip disturbance, which holds still over a period (derivations/uncertainty.md).
  void disturbance(Eigen::Vector3d& tangent, const Eigen::Vector3d& drive) {
    for (Eigen::Index i = 0; i < terms_.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double motion = terms_.of_turn[k] ? drive.z() : drive.x();
      tangent[static_cast<Eigen::Index>(terms_.channels[k])] +=
          std::sqrt(model_.uncertainty.inflation) * deviation_[i] * motion;
      deviation_[i] = kept_ * deviation_[i] + std::sqrt(1.0 - kept_ * kept_) * nominal_[i] * normal_(random_);
    }
  }

  const UncertainModel& model_;
  const DisturbedTerms& terms_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::array<double, 3> constant_{};
  double kept_ = 0.0;          ///< of the deviation over a period
  Eigen::VectorXd nominal_;    ///< standard deviations of the disturbed terms
  Eigen::VectorXd deviation_;  ///< of these terms now
};

}  // namespace

Eigen::MatrixXd draw_parameters(const UncertainModel& model, std::size_t samples, std::uint64_t seed) {
  check_uncertainty(model);
  const Eigen::MatrixXd root = covariance_root(model.uncertainty.covariance) * std::sqrt(model.uncertainty.inflation);
  Eigen::MatrixXd drawn(model.parameters.size(), static_cast<Eigen::Index>(samples));
  for (std::size_t s = 0; s < samples; ++s) {
    std::mt19937_64 random = generator(seed, s, kParameters);
    std::normal_distribution<double> normal;
    Eigen::VectorXd unit(root.cols());
    for (double& number : unit) {
      number = normal(random);
    }
    drawn.col(static_cast<Eigen::Index>(s)) = model.parameters + root * unit;
  }
  return drawn;
}

void sample_futures(const UncertainModel& model, const RolloutBatch<double>& batch, std::uint64_t seed,
                    const FutureOutputs& outputs, const RolloutOptions& options) {
  const std::size_t poses = batch.rollouts * batch.periods;
  const std::size_t samples = poses > 0 ? outputs.x.size() / poses : 0;
  if (poses > 0 && (samples == 0 || outputs.x.size() != samples * poses || outputs.y.size() != outputs.x.size() ||
                    outputs.theta.size() != outputs.x.size())) {
    throw std::invalid_argument("the poses of every sample need room for " + std::to_string(poses) +
                                " numbers in x, y and theta each, got " + std::to_string(outputs.x.size()));
  }
  const std::vector<DrivenPeriod> driven = driven_periods(model, batch, options);
  const DisturbedTerms terms = disturbed_terms_of(model);
  const Eigen::MatrixXd parameters = draw_parameters(model, samples, seed);
  share_out(samples, options.threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t s = first; s < last; ++s) {
      const RolloutProgram program =
          moved(model, parameters.col(static_cast<Eigen::Index>(s)), draw_ahead(model, s, seed));
      const RolloutPaths paths = roll_paths(program, batch, {1, options.level});
      for (std::size_t n = 0; n < batch.rollouts; ++n) {
        NoisyPath noisy(model, terms, generator(seed, s, n));
        const Pose2 start = batch.starts[batch.starts.size() > 1 ? n : 0].pose;
        Pose2 before = start, pose = start;
        for (std::size_t k = 0; k < batch.periods; ++k) {
          pose = noisy.next(pose, period_tangent(before, paths.at(k, n)), driven[k * batch.rollouts + n]);
          before = paths.at(k, n);
          const std::size_t at = s * poses + k * batch.rollouts + n;
          outputs.x[at] = pose.x;
          outputs.y[at] = pose.y;
          outputs.theta[at] = pose.theta;
        }
      }
    }
  });
}

}  // namespace slipwise
