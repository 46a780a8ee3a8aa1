// SPDX-License-Identifier: Apache-2.0
// Drawing parameters, the slip disturbance and slip noise.
#include "slipwise/rollout/sampled_futures.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "slipwise/linear/symmetric_eigen.hpp"
#include "slipwise/rollout/block_of_batch.hpp"
#include "slipwise/rollout/check_batch.hpp"
#include "slipwise/rollout/kernel_of_level.hpp"
#include "slipwise/rollout/lane_noise_job.hpp"
#include "slipwise/rollout/rollout_threads.hpp"

namespace slipwise {
namespace {

/// Numbers for one sample of one rollout (Steele, Lea and Flood 2014): neighbours' do not depend on each other.
class SplitMix {
 public:
  SplitMix(std::uint64_t seed, std::uint64_t sample, std::uint64_t rollout) : state_(seed) {
    for (const std::uint64_t part : {sample, rollout}) {
      state_ += kGolden * part;
      state_ = next();
    }
  }

  std::uint64_t next() {
    state_ += kGolden;
    std::uint64_t mixed = state_;
    mixed = (mixed ^ (mixed >> 30U)) * 0xBF58476D1CE4E5B9U;
    mixed = (mixed ^ (mixed >> 27U)) * 0x94D049BB133111EBU;
    return mixed ^ (mixed >> 31U);
  }

 private:
  static constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15U;
  std::uint64_t state_;
};

std::mt19937_64 generator(std::uint64_t seed, std::uint64_t sample, std::uint64_t rollout) {
  return std::mt19937_64(SplitMix(seed, sample, rollout).next());
}

static_assert(static_cast<std::size_t>(kMostDisturbed) == kMostDisturbedLanes);

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

/// The numbers of futures that all samples share.
template <typename Scalar>
class FutureNumbers {
 public:
  FutureNumbers(const UncertainModel& model, double period)
      : terms_(disturbed_terms_of(model)), law_(model.uncertainty.disturbance) {
    const ModelUncertainty& uncertainty = model.uncertainty;
    numbers_.noise = lane_noise<Scalar>(uncertainty.noise, uncertainty.inflation * uncertainty.scale);
    numbers_.disturbed = static_cast<std::size_t>(terms_.size());
    for (std::size_t i = 0; i < numbers_.disturbed; ++i) {
      numbers_.channel[i] = static_cast<std::size_t>(terms_.channels[i]);
      numbers_.of_turn[i] = terms_.of_turn[i];
    }
    for (const SlipDisturbance& candidate : law_.candidates) {
      deviations_.emplace_back(
          (uncertainty.inflation * terms_.variances(candidate)).cwiseSqrt().template cast<Scalar>());
      kept_.push_back(static_cast<Scalar>(std::exp(-period / candidate.time_constant)));
    }
  }

  /// Those of some rollouts of one sample, of which each has random numbers of its own.
  LaneFutures<Scalar>& of(std::uint64_t seed, std::uint64_t sample, std::size_t first, std::size_t count) {
    for (std::size_t lane = 0; lane < count; ++lane) {
      SplitMix random(seed, sample, first + lane);
      for (auto& row : numbers_.seeds) {
        row[lane] = static_cast<std::uint32_t>(random.next() >> 32U);
      }
      if (numbers_.disturbed > 0) {
        const std::size_t which = drawn_candidate(static_cast<double>(random.next() >> 11U) * 0x1p-53);
        numbers_.kept[lane] = kept_[which];
        for (std::size_t i = 0; i < numbers_.disturbed; ++i) {
          numbers_.deviation[i][lane] = deviations_[which][static_cast<Eigen::Index>(i)];
        }
      }
    }
    return numbers_;
  }

 private:
  std::size_t drawn_candidate(double uniform) const {
    std::size_t which = 0;
    for (; which + 1 < kept_.size(); ++which) {
      uniform -= law_.weights[static_cast<Eigen::Index>(which)];
      if (uniform < 0.0) {
        break;
      }
    }
    return which;
  }

  DisturbedTerms terms_;
  const DisturbanceModel& law_;
  std::vector<Eigen::VectorX<Scalar>> deviations_;  ///< of each candidate
  std::vector<Scalar> kept_;
  LaneFutures<Scalar> numbers_{};
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

template <typename Scalar>
void sample_futures(const UncertainModel& model, const RolloutBatch<Scalar>& batch, std::uint64_t seed,
                    const FutureOutputs<Scalar>& outputs, const RolloutOptions& options) {
  const std::size_t poses = batch.rollouts * batch.periods;
  const std::size_t samples = poses > 0 ? outputs.x.size() / poses : 0;
  if (poses > 0 && (samples == 0 || outputs.x.size() != samples * poses || outputs.y.size() != outputs.x.size() ||
                    outputs.theta.size() != outputs.x.size())) {
    throw std::invalid_argument("the poses of every sample need room for " + std::to_string(poses) +
                                " numbers in x, y and theta each, got " + std::to_string(outputs.x.size()));
  }
  check_batch(batch);
  const Eigen::MatrixXd parameters = draw_parameters(model, samples, seed);
  const LaneKernelOfLevel<Scalar> kernel = uncertain_kernels_of<Scalar>(options.level).futures;
  std::atomic<unsigned> faults = kNoFault;
  share_out(samples, options.threads, [&](std::size_t first, std::size_t last) {
    FutureNumbers<Scalar> numbers(model, model.setting.period);
    for (std::size_t s = first; s < last; ++s) {
      const RolloutProgram program =
          moved(model, parameters.col(static_cast<Eigen::Index>(s)), draw_ahead(model, s, seed));
      check_axes(program, batch);
      RolloutOutputs<Scalar> paths;
      paths.x = &outputs.x[s * poses];
      paths.y = &outputs.y[s * poses];
      paths.theta = &outputs.theta[s * poses];
      LaneJob<Scalar> job = job_of(program, batch, paths);
      job.futures = &numbers.of(seed, s, 0, 0);
      BlockOfBatch<Scalar> place(program, batch, nullptr, kernel, job);
      for (std::size_t n = 0; n < batch.rollouts; n += kernel.lanes) {
        numbers.of(seed, s, n, std::min(kernel.lanes, batch.rollouts - n));
        faults |= place.roll(n / kernel.lanes);
      }
    }
  });
  check_commands(batch, 0);
  if (faults != kNoFault) {
    refuse(faults);
  }
}

template void sample_futures<float>(const UncertainModel&, const RolloutBatch<float>&, std::uint64_t,
                                    const FutureOutputs<float>&, const RolloutOptions&);
template void sample_futures<double>(const UncertainModel&, const RolloutBatch<double>&, std::uint64_t,
                                     const FutureOutputs<double>&, const RolloutOptions&);

}  // namespace slipwise
