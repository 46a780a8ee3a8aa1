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
constexpr std::size_t kOfLine = kLineBytes / sizeof(double);

/// A line of the processor's cache: a vector that lies across two of them is read twice.
struct alignas(kLineBytes) Line {
  std::array<double, kOfLine> numbers{};
};

/// Blocks of a batch with their tangents, one thread's.
class TangentBlocks {
 public:
  TangentBlocks(const TangentPlan& plan, const RolloutBatch<double>& batch, const LaneKernelOfLevel<double>& kernel,
                std::span<double> out)
      : start_(plan.actuator_places().size()),
        tangents_(plan.lanes()),
        state_((2 * tangent_rows(tangents_) * kernel.lanes + kOfLine - 1) / kOfLine),
        job_(job_of(plan.program(), batch, RolloutOutputs<double>{})),
        place_(plan.program(), batch, nullptr, kernel, with_tangents(out)) {
    if (!start_.empty()) {
      place_.differentiate({&plan.actuator(), plan.actuator_places(), start_.data()});
    }
  }

  /// Returns its faults.
  unsigned roll(std::size_t block) { return place_.roll(block); }

 private:
  const LaneJob<double>& with_tangents(std::span<double> out) {
    tangents_.start = start_.data();
    tangents_.state = state_.front().numbers.data();  // there always are rows of noise
    tangents_.out = out.data();
    job_.tangents = &tangents_;
    return job_;
  }

  std::vector<StartTangent<double>> start_;
  LaneTangents<double> tangents_;
  std::vector<Line> state_;
  LaneJob<double> job_;
  BlockOfBatch<double> place_;
};

}  // namespace

void rollout_covariance(const UncertainModel& model, const RolloutBatch<double>& batch, std::span<double> out,
                        std::span<const double> growth, const RolloutOptions& options) {
  check_uncertainty(model);
  check_batch(batch);
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
  const TangentPlan plan(model, batch.periods, growth);
  check_axes(plan.program(), batch);
  const LaneKernelOfLevel<double> kernel = uncertain_kernels_of(options.level).tangents;
  std::atomic<unsigned> faults = kNoFault;
  share_out((batch.rollouts + kernel.lanes - 1) / kernel.lanes, options.threads,
            [&](std::size_t block, std::size_t last) {
              TangentBlocks blocks(plan, batch, kernel, out);
              for (; block < last; ++block) {
                faults |= blocks.roll(block);
              }
            });
  check_commands(batch, faults == kNoFault ? first_unused(job_of(plan.program(), batch, RolloutOutputs<double>{})) : 0);
  if (faults != kNoFault) {
    refuse(faults);
  }
}

}  // namespace slipwise
