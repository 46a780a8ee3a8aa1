// SPDX-License-Identifier: Apache-2.0
// Bringing a batch to the GPU and its results back.
#include "slipwise/rollout/gpu/gpu.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace slipwise {
namespace {

/// Copies numbers that lie in one piece.
template <typename Number>
void copy_numbers(const Number* from, std::size_t count, Number* to) {
  const std::size_t bytes = count * sizeof(Number);
  gpu_copy({.to = to, .to_pitch = bytes, .from = from, .from_pitch = bytes, .width = bytes, .rows = 1});
}

/// The job with its program inside; its pointers are still those of the batch.
template <typename Scalar>
ThreadJob<Scalar> thread_job(const GpuBatch<Scalar>& batch) {
  const LaneJob<Scalar>& job = batch.job;
  ThreadJob<Scalar> given{};
  given.job = job;
  given.past_count = batch.past_count;
  given.past_stride = batch.past_stride;
  given.used = batch.used;
  const std::size_t coefficients = job.part_end * job.product_count * 3 * (1 + job.edge_count);
  if (job.part_end > std::size(given.parts) || coefficients > std::size(given.coefficients)) {
    throw std::invalid_argument(
        "a period of this model is " + std::to_string(job.part_end) + " steps with " + std::to_string(coefficients) +
        " numbers, and a GPU has room for " + std::to_string(std::size(given.parts)) + " with " +
        std::to_string(std::size(given.coefficients)) + "; use shorter periods, fewer terms, or the processor");
  }
  std::copy_n(job.parts, job.part_end, given.parts);
  std::copy_n(job.coefficients, coefficients, given.coefficients);
  std::copy_n(job.products, job.product_count, given.products);
  return given;
}

/// An array of results: where the job has its pointer, and how many numbers it holds.
template <typename Scalar>
struct GpuOutput {
  Scalar** pointer;
  std::size_t count;
};

template <typename Scalar>
std::array<GpuOutput<Scalar>, 9> outputs_of(LaneJob<Scalar>& job) {
  const std::size_t ends = job.rollouts;
  const std::size_t poses = job.rollouts * job.periods;
  return {{{&job.path[0], poses},
           {&job.path[1], poses},
           {&job.path[2], poses},
           {&job.end[0], ends},
           {&job.end[1], ends},
           {&job.end[2], ends},
           {&job.cost_sum, ends},
           {&job.cost_highest, ends},
           {&job.cost_lowest, ends}}};
}

}  // namespace

void* GpuMemory::at_least(std::size_t bytes) {
  if (bytes > bytes_) {
    gpu_free(memory_);
    memory_ = nullptr;
    bytes_ = 0;
    memory_ = gpu_allocate(bytes);
    bytes_ = bytes;
  }
  return memory_;
}

Gpu::Gpu() {
  if (const std::string reason = why_no_gpu(); !reason.empty()) {
    throw std::invalid_argument(reason);
  }
}

template <typename Number>
const Number* Gpu::bring(const Number* numbers, std::size_t count, GpuMemory& memory) {
  if (count == 0 || lies_on_gpu(numbers)) {
    return numbers;
  }
  auto* there = memory.room_for<Number>(count);
  copy_numbers(numbers, count, there);
  return there;
}

/// Commands of the processor's memory, in rows of a period each.
template <typename Scalar>
const Scalar* Gpu::bring_rows(const Scalar* commands, const LaneJob<Scalar>& job, GpuMemory& memory) {
  const std::size_t width = job.rollouts * sizeof(Scalar);
  auto* there = memory.room_for<Scalar>(job.rollouts * job.periods);
  if (job.rollout_stride == 1 && job.period_stride >= static_cast<std::ptrdiff_t>(job.rollouts)) {
    gpu_copy({.to = there,
              .to_pitch = width,
              .from = commands,
              .from_pitch = static_cast<std::size_t>(job.period_stride) * sizeof(Scalar),
              .width = width,
              .rows = job.periods});
    return there;
  }
  side_by_side_.resize(width * job.periods);
  auto* row = reinterpret_cast<Scalar*>(side_by_side_.data());
  for (std::size_t k = 0; k < job.periods; ++k, row += job.rollouts) {
    const Scalar* from = commands + static_cast<std::ptrdiff_t>(k) * job.period_stride;
    for (std::size_t n = 0; n < job.rollouts; ++n) {
      row[n] = from[static_cast<std::ptrdiff_t>(n) * job.rollout_stride];
    }
  }
  copy_numbers(reinterpret_cast<const Scalar*>(side_by_side_.data()), job.rollouts * job.periods, there);
  return there;
}

template <typename Scalar>
void Gpu::bring_commands(LaneJob<Scalar>& job) {
  const bool there = lies_on_gpu(job.v);
  if (there != lies_on_gpu(job.omega) || (job.vy != nullptr && there != lies_on_gpu(job.vy))) {
    throw std::invalid_argument("speeds and yaw rates must all lie in the processor's memory, or all in the GPU's");
  }
  if (!there) {
    job.vy = job.vy != nullptr ? bring_rows(job.vy, job, vy_) : nullptr;
    job.v = bring_rows(job.v, job, v_);
    job.omega = bring_rows(job.omega, job, omega_);
    job.rollout_stride = 1;
    job.period_stride = static_cast<std::ptrdiff_t>(job.rollouts);
  }
}

template <typename Scalar>
unsigned Gpu::roll(const GpuBatch<Scalar>& batch) {
  const std::scoped_lock lock(one_at_a_time_);
  ThreadJob<Scalar> given = thread_job(batch);
  bring_commands(given.job);
  if (batch.starts.size() == kStartRows) {
    std::ranges::copy(batch.starts, given.start);
  } else {
    given.starts = bring(batch.starts.data(), batch.starts.size(), starts_);
  }
  given.past = bring(batch.past.data(), batch.past.size(), past_);
  LaneMap<Scalar>& map = given.job.map;
  map.cells = bring(map.cells, map.columns * static_cast<std::size_t>(map.height), cells_);

  LaneJob<Scalar> wanted = batch.job;
  const auto results = outputs_of(wanted);
  const auto theirs = outputs_of(given.job);
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (*results[i].pointer != nullptr && !lies_on_gpu(*results[i].pointer)) {
      *theirs[i].pointer = outputs_[i].room_for<Scalar>(results[i].count);
    }
  }
  auto* faults = faults_.room_for<unsigned>(1);
  unsigned found = gpu_roll(given, false, faults);
  if ((found & kTurnsTooFar) != 0) {
    found = gpu_roll(given, true, faults);
  }
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (*theirs[i].pointer != *results[i].pointer) {
      copy_numbers(*theirs[i].pointer, results[i].count, *results[i].pointer);
    }
  }
  return found;
}

template unsigned Gpu::roll(const GpuBatch<float>&);
template unsigned Gpu::roll(const GpuBatch<double>&);

}  // namespace slipwise
