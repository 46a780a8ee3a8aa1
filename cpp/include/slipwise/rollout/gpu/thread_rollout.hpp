// SPDX-License-Identifier: Apache-2.0
// One rollout by one thread of a GPU: the same kernel, with a single lane, from a job that holds its own program.
#pragma once

#include "slipwise/rollout/lane_kernel.hpp"

// Plain arrays: a job is copied to the GPU as it lies in memory.
// NOLINTBEGIN(modernize-avoid-c-arrays)
namespace slipwise {

/// A vector of one number.
template <typename Number>
struct OneLane {
  using Scalar = Number;
  using Vector = Number;
  static constexpr std::size_t kLanes = 1;
};

inline constexpr std::size_t kMostThreadParts = 48;             ///< of a control period
inline constexpr std::size_t kThreadCoefficientBytes = 16384;   ///< of all parts' coefficients
inline constexpr std::size_t kMostThreadJobBytes = 32764 - 16;  ///< what a kernel may be given directly (CUDA 12.1)

/// All that the threads of a batch share. It is passed as a kernel's parameter, which lies in constant memory: every
/// thread reads the same number of it at the same time. Pointers are those of the GPU's memory.
template <typename Scalar>
struct ThreadJob {
  LaneJob<Scalar> job;       ///< its parts, coefficients and products are those below
  const Scalar* starts;      ///< [kStartRows][rollouts]; null where all start alike
  Scalar start[kStartRows];  ///< where all start alike
  const DriveCommand* past;
  std::size_t past_count;   ///< of one start
  std::size_t past_stride;  ///< from one rollout's to the next one's
  std::size_t used;         ///< periods from which on no pose depends on a command
  LanePart<Scalar> parts[kMostThreadParts];
  Scalar coefficients[kThreadCoefficientBytes / sizeof(Scalar)];
  LaneProduct products[kMostProducts];
};
static_assert(sizeof(ThreadJob<double>) <= kMostThreadJobBytes);

/// Commands that no pose depends on must be finite as well.
template <typename Scalar>
SLIPWISE_LANES unsigned find_unused_faults(const ThreadJob<Scalar>& given, std::size_t rollout) {
  const LaneJob<Scalar>& job = given.job;
  bool finite = true;
  for (std::size_t k = given.used; k < job.periods; ++k) {
    const std::ptrdiff_t at =
        static_cast<std::ptrdiff_t>(rollout) * job.rollout_stride + static_cast<std::ptrdiff_t>(k) * job.period_stride;
    finite &= (job.v[at] - job.v[at]) + (job.omega[at] - job.omega[at]) == 0;
    finite &= job.vy == nullptr || job.vy[at] - job.vy[at] == 0;
  }
  return finite ? kNoFault : kNotFinite;
}

/// Drives one rollout and says what went wrong, as bits.
template <Actuator kActuator, Slip kSlip, bool kWide, typename Scalar>
SLIPWISE_LANES unsigned roll_thread(const ThreadJob<Scalar>& given, std::size_t rollout) {
  LaneJob<Scalar> job = given.job;
  job.parts = given.parts;
  job.coefficients = given.coefficients;
  job.products = given.products;
  Scalar rows[kStartRows];
  for (std::size_t i = 0; i < kStartRows; ++i) {
    rows[i] = given.starts != nullptr ? given.starts[i * job.rollouts + rollout] : given.start[i];
  }
  LaneBlock<Scalar> block;
  point_to_rows(rows, 1, block);
  block.past = given.past + rollout * given.past_stride;
  block.past_count = given.past_count;
  block.past_stride = given.past_stride;
  block.first = rollout;
  block.count = 1;
  block.side_by_side = true;
  return roll_block_as<OneLane<Scalar>, kActuator, kSlip, kWide>(job, block) | find_unused_faults(given, rollout);
}

/// Calls `work.call<kActuator, kSlip, kWide>()` with what the job needs.
template <Slip kSlip, bool kWide, typename Scalar, class Work>
void with_thread_actuator(const LaneJob<Scalar>& job, const Work& work) {
  switch (actuator_of(job)) {
    case Actuator::None:
      return work.template call<Actuator::None, kSlip, kWide>();
    case Actuator::Delays:
      return work.template call<Actuator::Delays, kSlip, kWide>();
    case Actuator::Lags:
      return work.template call<Actuator::Lags, kSlip, kWide>();
    case Actuator::Response:
      return work.template call<Actuator::Response, kSlip, kWide>();
  }
}
template <typename Scalar, class Work>
void with_thread_kernel(const LaneJob<Scalar>& job, bool wide, const Work& work) {
  if (needs_any(job)) {
    with_thread_actuator<Slip::Any, true>(job, work);
  } else if (job.is_quadratic) {
    wide ? with_thread_actuator<Slip::Quadratic, true>(job, work)
         : with_thread_actuator<Slip::Quadratic, false>(job, work);
  } else {
    wide ? with_thread_actuator<Slip::Products, true>(job, work)
         : with_thread_actuator<Slip::Products, false>(job, work);
  }
}

}  // namespace slipwise
// NOLINTEND(modernize-avoid-c-arrays)
