// SPDX-License-Identifier: Apache-2.0
// Limits of the drive in lanes: what dead-band, saturation and ramps leave of the commands of a block, piece by piece.
#pragma once

#include "slipwise/actuator/axis_limit.hpp"
#include "slipwise/rollout/lane_actuator.hpp"
#include "slipwise/rollout/lane_job.hpp"
#include "slipwise/rollout/lanes.hpp"

namespace slipwise {

/// What speed and yaw rate, or a side, aim at.
template <typename Scalar, class Vector>
SLIPWISE_LANES Vector aim(const RampLimits<Scalar>& limits, const Vector& command) {
  return limited(limits, command);
}
template <typename Scalar, class Half>
SLIPWISE_LANES Pair<Half> aim(const RampLimits<Scalar>& limits, const Pair<Half>& command) {
  return {aim(limits, command.low), aim(limits, command.high)};
}

/// The same of rates behind a lag, as AxisRamp has it; what its lag is given for a piece is returned.
template <typename Scalar, class Vector>
SLIPWISE_LANES Vector kept_near(const RampLimits<Scalar>& limits, const Vector& target, Vector& state) {
  const Vector zero{};
  const Vector one = zero + static_cast<Scalar>(1);
  const Vector up = target < state ? -one : one;
  const Vector from = state * up;
  const Vector to = target * up;
  const Vector wanted = (to - from) * limits.closes;
  const Vector rate = from < zero ? zero + limits.slew_rate_down : zero + limits.slew_rate_up;
  const Vector braked = smaller(wanted, rate);
  const Vector rest = one + from / braked;
  const Vector turned = smaller(braked, rest * limits.slew_rate_up - from);
  const Vector moved = from < zero ? (from + braked > zero ? turned : braked) : braked;
  const Vector kept = moved < wanted ? from + moved * limits.per_closes : to;
  state = moved < wanted ? (from + moved) * up : (from + wanted) * up;
  return kept * up;
}

/// One piece of the ramp towards `target`; `state` moves on, and the mean over the piece is returned. Mirrored so that
/// it goes up, a ramp is braking until zero and acceleration from there on; times are counted in pieces.
template <typename Scalar, class Vector>
SLIPWISE_LANES Vector ramp_piece(const RampLimits<Scalar>& limits, const Vector& target, Vector& state) {
  if (limits.lags) {
    return kept_near(limits, target, state);
  }
  const Vector zero{};
  const Vector one = zero + static_cast<Scalar>(1);
  const auto half = static_cast<Scalar>(0.5);
  const Vector up = target < state ? -one : one;
  const Vector from = state * up;
  const Vector to = target * up;
  const Vector stop = larger(from, smaller(to, zero));  // where braking ends
  const Vector slower = smaller(stop - from, zero + limits.slew_rate_down);
  const Vector in_braking = slower * limits.per_slew_down;
  const Vector left = slower < stop - from ? zero : to - stop;
  const Vector faster = smaller(left, larger(one - in_braking, zero) * limits.slew_rate_up);
  const Vector in_speeding = faster * limits.per_slew_up;
  const Vector moved = slower + faster;
  const Vector end = moved < to - from ? from + moved : to;
  state = end * up;
  return (end - (faster + slower * half) * in_braking - faster * half * in_speeding) * up;
}
template <typename Scalar, class Half>
SLIPWISE_LANES Pair<Half> ramp_piece(const RampLimits<Scalar>& limits, const Pair<Half>& target, Pair<Half>& state) {
  return {ramp_piece(limits, target.low, state.low), ramp_piece(limits, target.high, state.high)};
}

/// The drives of a block: what their ramps hold.
template <class L>
struct RampLanes {
  L::Vector speed, yaw_rate, left, right;
};

/// The limited commands of one piece, from what speed and yaw rate aim at.
template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES void limit_piece(const DriveRamps<Scalar>& limits, RampLanes<L>& ramps, typename L::Vector& v,
                                typename L::Vector& omega) {
  if (limits.speed.ramps) {
    v = ramp_piece(limits.speed, v, ramps.speed);
  }
  if (limits.yaw_rate.ramps) {
    omega = ramp_piece(limits.yaw_rate, omega, ramps.yaw_rate);
  }
  if (limits.sides) {
    const typename L::Vector asked = v * limits.gain_v;
    const typename L::Vector apart = omega * limits.half_separation;
    typename L::Vector left = aim(limits.side, asked - apart);
    typename L::Vector right = aim(limits.side, asked + apart);
    if (limits.side.ramps) {
      left = ramp_piece(limits.side, left, ramps.left);
      right = ramp_piece(limits.side, right, ramps.right);
    }
    v = (left + right) * static_cast<Scalar>(0.5);
    omega = (right - left) * limits.per_separation;
  }
}

/// Puts the commands of a block behind the limits. A command that is not finite makes its pieces so too.
template <class Level, typename Scalar>
void limit_block(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block, const RampStart<Scalar>& start,
                 const LimitedRows<Scalar>& rows) {
  using L = Lanes<Level, Scalar>;
  const DriveRamps<Scalar>& limits = *job.limits;
  const auto first = static_cast<std::ptrdiff_t>(block.first) * job.rollout_stride;
  const CommandSource<Scalar> source_v{job.v + first, &block.v, &DriveCommand::v};
  const CommandSource<Scalar> source_omega{job.omega + first, &block.omega, &DriveCommand::omega};
  RampLanes<L> ramps;
  load(start.speed, ramps.speed);
  load(start.yaw_rate, ramps.yaw_rate);
  load(start.left, ramps.left);
  load(start.right, ramps.right);
  const CommandSource<Scalar> source_vy{job.vy + (job.vy != nullptr ? first : 0), &block.vy, &DriveCommand::vy};
  std::size_t row = 0;
  for (std::size_t period = 0; period < rows.periods; ++period) {
    typename L::Vector commanded_v;
    typename L::Vector commanded_omega;
    read_commands<L>(job, block, source_v, static_cast<std::ptrdiff_t>(period), commanded_v);
    read_commands<L>(job, block, source_omega, static_cast<std::ptrdiff_t>(period), commanded_omega);
    typename L::Vector vy;  // passes as it is
    fill(static_cast<Scalar>(0), vy);
    if (job.vy != nullptr) {
      read_commands<L>(job, block, source_vy, static_cast<std::ptrdiff_t>(period), vy);
    }
    const typename L::Vector aimed_v = aim(limits.speed, commanded_v);
    const typename L::Vector aimed_omega = aim(limits.yaw_rate, commanded_omega);
    const typename L::Vector nothing = (commanded_v - commanded_v) + (commanded_omega - commanded_omega);
    for (std::size_t piece = 0; piece < job.pieces; ++piece, row += L::kLanes) {
      typename L::Vector v = aimed_v;
      typename L::Vector omega = aimed_omega;
      limit_piece<L>(limits, ramps, v, omega);
      store(v + nothing, rows.v + row);
      store(omega + nothing, rows.omega + row);
      if (job.vy != nullptr) {
        store(vy, rows.vy + row);
      }
    }
  }
}

}  // namespace slipwise
