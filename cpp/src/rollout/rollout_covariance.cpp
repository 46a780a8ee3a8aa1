// SPDX-License-Identifier: Apache-2.0
// Hands the blocks of a batch to the kernel of tangents.
#include "slipwise/rollout/rollout_covariance.hpp"

#include <array>
#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

#include "slipwise/rollout/block_of_batch.hpp"
#include "slipwise/rollout/check_batch.hpp"
#include "slipwise/rollout/kernel_of_level.hpp"
#include "slipwise/rollout/lane_actuator.hpp"
#include "slipwise/rollout/rollout_threads.hpp"
#include "slipwise/rollout/tangent_plan.hpp"

namespace slipwise {
namespace {

constexpr std::size_t kEntries = 6;

/// A line of the processor's cache: a vector that lies across two of them is read twice.
template <typename Scalar>
struct alignas(kLineBytes) Line {
  static constexpr std::size_t kNumbers = kLineBytes / sizeof(Scalar);
  std::array<Scalar, kNumbers> numbers{};
};

/// Blocks of a batch with their tangents, one thread's.
template <typename Scalar>
class TangentBlocks {
 public:
  TangentBlocks(const TangentPlan<Scalar>& plan, const RolloutBatch<Scalar>& batch,
                const LaneKernelOfLevel<Scalar>& kernel, std::span<Scalar> out)
      : start_(plan.actuator_places().size()),
        tangents_(plan.lanes()),
        state_((2 * tangent_rows(tangents_) * kernel.lanes + Line<Scalar>::kNumbers - 1) / Line<Scalar>::kNumbers),
        job_(job_of(plan.program(), batch, RolloutOutputs<Scalar>{})),
        place_(plan.program(), batch, nullptr, kernel, with_tangents(out)) {
    if (!start_.empty()) {
      place_.differentiate({&plan.actuator(), plan.actuator_places(), start_.data()});
    }
  }

  /// Returns its faults.
  unsigned roll(std::size_t block) { return place_.roll(block); }

 private:
  const LaneJob<Scalar>& with_tangents(std::span<Scalar> out) {
    tangents_.start = start_.data();
    tangents_.state = state_.front().numbers.data();  // there always are rows of noise
    tangents_.out = out.data();
    job_.tangents = &tangents_;
    return job_;
  }

  std::vector<StartTangent<Scalar>> start_;
  LaneTangents<Scalar> tangents_;
  std::vector<Line<Scalar>> state_;
  LaneJob<Scalar> job_;
  BlockOfBatch<Scalar> place_;
};

/// The starts at the origin: covariances are the same anywhere, and there the fewest digits are lost.
std::vector<RolloutStart> at_origin(std::span<const RolloutStart> starts) {
  std::vector<RolloutStart> found(starts.begin(), starts.end());
  for (RolloutStart& start : found) {
    start.pose.x = start.pose.y = 0.0;
  }
  return found;
}

}  // namespace

template <typename Scalar>
void rollout_covariance(const UncertainModel& model, const RolloutBatch<Scalar>& batch,
                        std::span<std::type_identity_t<Scalar>> out, std::span<const double> growth,
                        const RolloutOptions& options) {
  check_uncertainty(model);
  check_batch(batch);
  const std::vector<RolloutStart> starts = at_origin(batch.starts);
  RolloutBatch<Scalar> from_origin = batch;
  from_origin.starts = starts;
  const std::size_t poses = batch.rollouts * batch.periods;
  if (out.size() != kEntries * poses) {
    throw std::invalid_argument("the covariances of " + std::to_string(poses) + " poses are " +
                                std::to_string(kEntries * poses) + " numbers, got room for " +
                                std::to_string(out.size()));
  }
  if (!growth.empty() && growth.size() != batch.periods) {
    throw std::invalid_argument("the covariances of " + std::to_string(batch.periods) + " periods grow by " +
                                std::to_string(growth.size()) + " factors; give one for each, or none");
  }
  const TangentPlan<Scalar> plan(model, batch.periods, growth);
  check_axes(plan.program(), batch);
  const LaneKernelOfLevel<Scalar> kernel = uncertain_kernels_of<Scalar>(options.level).tangents;
  std::atomic<unsigned> faults = kNoFault;
  share_out((batch.rollouts + kernel.lanes - 1) / kernel.lanes, options.threads,
            [&](std::size_t block, std::size_t last) {
              TangentBlocks<Scalar> blocks(plan, from_origin, kernel, out);
              for (; block < last; ++block) {
                faults |= blocks.roll(block);
              }
            });
  check_commands(batch, faults == kNoFault ? first_unused(job_of(plan.program(), batch, RolloutOutputs<Scalar>{})) : 0);
  if (faults != kNoFault) {
    refuse(faults);
  }
}

template void rollout_covariance<float>(const UncertainModel&, const RolloutBatch<float>&, std::span<float>,
                                        std::span<const double>, const RolloutOptions&);
template void rollout_covariance<double>(const UncertainModel&, const RolloutBatch<double>&, std::span<double>,
                                         std::span<const double>, const RolloutOptions&);

}  // namespace slipwise
