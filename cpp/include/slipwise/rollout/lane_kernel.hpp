// SPDX-License-Identifier: Apache-2.0
// The rollout of one block of lanes: command chain, slip, exact steps, outputs. Compiled once per instruction level.
#pragma once

#include "slipwise/rollout/lane_drive.hpp"
#include "slipwise/rollout/lane_job.hpp"
#include "slipwise/rollout/lane_output.hpp"
#include "slipwise/rollout/lane_path.hpp"
#include "slipwise/rollout/lane_slip.hpp"
#include "slipwise/rollout/lanes.hpp"

namespace slipwise {

template <class L, typename Scalar>
SLIPWISE_LANES bool any_above(const typename L::Row& row, Scalar limit, std::size_t count) {
  alignas(64) Scalar values[L::kLanes];
  store_row<L>(row, values);
  bool above = false;
  for (std::size_t i = 0; i < count; ++i) {
    above |= values[i] > limit;
  }
  return above;
}

/// Rolls the block out. `kWide` also takes steps that turn by more than kLaneTurn.
template <class L, typename Scalar, bool kLags, bool kWide>
[[gnu::noinline]] unsigned roll_block_as(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block) {
  const bool side_by_side = job.rollout_stride == 1 && block.count == L::kLanes;
  ChannelLanes<L, Scalar> v({job, block, job.v, block.v, &DriveCommand::v, side_by_side}, job.shift_v);
  ChannelLanes<L, Scalar> omega({job, block, job.omega, block.omega, &DriveCommand::omega, side_by_side},
                                job.shift_omega);
  PathLanes<L, Scalar> path(block);
  OutputLanes<L, Scalar> output(job, block);
  for (std::size_t period = 0; period < job.periods; ++period) {
    for (std::size_t i = 0; i < job.part_count; ++i) {
      const LanePart<Scalar>& part = job.parts[i];
      typename L::Row mean_v;
      typename L::Row mean_omega;
      v.template advance<kLags>(part.next_v, part.mean_gap_v, part.end_gap_v, mean_v);
      omega.template advance<kLags>(part.next_omega, part.mean_gap_omega, part.end_gap_omega, mean_omega);
      TangentLanes<L> tangent;
      slip_tangent<L>(job, job.shares + part.first_share, mean_v, mean_omega, tangent);
      path.template step<kWide>(tangent);
    }
    output.write_period(path, period);
  }
  output.write_end(path);
  constexpr double kWidest = kWide ? kWidestLaneTurn : kLaneTurn;
  const unsigned turns =
      any_above<L>(path.widest_squared, static_cast<Scalar>(kWidest * kWidest), block.count) ? kTurnsTooFar : kNoFault;
  return turns | (output.all_finite(path) ? kNoFault : kNotFinite);
}

template <class L, typename Scalar, bool kLags>
unsigned roll_block_with(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block) {
  const unsigned fault = roll_block_as<L, Scalar, kLags, false>(job, block);
  return (fault & kTurnsTooFar) == 0 ? fault : roll_block_as<L, Scalar, kLags, true>(job, block);
}

template <class Level, typename Scalar>
unsigned roll_block(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block) {
  using L = Lanes<Level, Scalar>;
  return job.lags ? roll_block_with<L, Scalar, true>(job, block) : roll_block_with<L, Scalar, false>(job, block);
}

}  // namespace slipwise
