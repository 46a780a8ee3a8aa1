// SPDX-License-Identifier: Apache-2.0
// Checks a batch, shares its blocks out to threads, and calls the kernel of the processor.
#include "slipwise/rollout/rollout_batch.hpp"

#include <algorithm>
#include <atomic>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "slipwise/rollout/block_of_batch.hpp"
#include "slipwise/rollout/check_batch.hpp"
#include "slipwise/rollout/gpu/gpu.hpp"
#include "slipwise/rollout/kernel_of_level.hpp"
#include "slipwise/rollout/lane_job.hpp"
#include "slipwise/rollout/rollout_threads.hpp"

namespace slipwise {
namespace {

/// What went wrong in all rollouts, as bits; each block is computed on the processor, as if it were alone.
template <typename Scalar>
unsigned roll_blocks(const RolloutProgram& program, const RolloutBatch<Scalar>& batch, const Costmap* map,
                     const LaneJob<Scalar>& job, const RolloutOptions& options) {
  const LaneKernelOfLevel<Scalar> kernel = kernel_of<Scalar>(options.level);
  std::atomic<unsigned> faults = kNoFault;
  const std::size_t blocks = (batch.rollouts + kernel.lanes - 1) / kernel.lanes;
  share_out(blocks, options.threads, [&](std::size_t first, std::size_t last) {
    BlockOfBatch<Scalar> place(program, batch, map, kernel, job);
    unsigned found = kNoFault;
    for (std::size_t block = first; block < last; ++block) {
      found |= place.roll(block);
    }
    faults |= found;
  });
  return faults;
}

/// The same on a GPU.
template <typename Scalar>
unsigned roll_on(Gpu& gpu, const RolloutProgram& program, const RolloutBatch<Scalar>& batch, const Costmap* map,
                 const LaneJob<Scalar>& job) {
  if (program.limited()) {
    throw std::invalid_argument("a drive with limits is rolled out on the processor only; leave out the GPU");
  }
  BlockOfBatch<Scalar> place(program, batch, map,
                             {.roll = nullptr, .limit = nullptr, .drive_cars = nullptr, .lanes = kMostLanes}, job);
  const std::size_t starts = place.differs() ? batch.rollouts : 1;
  std::vector<Scalar> rows(kStartRows * starts);
  for (std::size_t first = 0; first < starts; first += kMostLanes) {
    const Scalar* row = place.at(first / kMostLanes).x;  // the first of kStartRows
    for (std::size_t i = 0; i < kStartRows; ++i, row += kMostLanes) {
      std::copy_n(row, std::min(kMostLanes, starts - first), &rows[i * starts + first]);
    }
  }
  const LaneBlock<Scalar>& block = place.at(0);
  return gpu.roll<Scalar>({.job = job,
                           .starts = rows,
                           .past = batch.past,
                           .past_count = block.past_count,
                           .past_stride = block.past_stride,
                           .used = first_unused(job)});
}

}  // namespace

template <typename Scalar>
void rollout_batch(const RolloutProgram& program, const RolloutBatch<Scalar>& batch,
                   const RolloutOutputs<Scalar>& outputs, const RolloutOptions& options) {
  check_batch(batch);
  check_axes(program, batch);
  const LaneJob<Scalar> job = job_of(program, batch, outputs);
  const bool out_of_sight = options.gpu != nullptr && lies_on_gpu(batch.commands.v);
  if (out_of_sight && hangs_on_commands(program.actuator())) {
    throw std::invalid_argument(
        "where a drive with a slow mode or a steering acts before it is commanded, its commands must lie in the "
        "processor's memory");
  }
  const unsigned faults = options.gpu != nullptr ? roll_on(*options.gpu, program, batch, outputs.map, job)
                                                 : roll_blocks(program, batch, outputs.map, job, options);
  if (!out_of_sight) {
    check_commands(batch, faults == kNoFault ? first_unused(job) : 0);
  }
  if (faults != kNoFault) {
    refuse(faults);
  }
}

template void rollout_batch(const RolloutProgram&, const RolloutBatch<float>&, const RolloutOutputs<float>&,
                            const RolloutOptions&);
template void rollout_batch(const RolloutProgram&, const RolloutBatch<double>&, const RolloutOutputs<double>&,
                            const RolloutOptions&);

}  // namespace slipwise
