// SPDX-License-Identifier: Apache-2.0
// The command actuator in lanes: which command acts now, and what the drive makes of it.
#pragma once

#include <cstdint>

#include "slipwise/rollout/drive_command.hpp"
#include "slipwise/rollout/lane_job.hpp"
#include "slipwise/rollout/lanes.hpp"

// Plain arrays: the functions of std::array would be compiled for the processor of one file and called from others.
// NOLINTBEGIN(modernize-avoid-c-arrays)
namespace slipwise {

inline constexpr std::size_t kLineBytes = 64;  ///< of the processor's cache

/// Where a block's commands of one channel are read from.
template <typename Scalar>
struct CommandSource {
  const Scalar* commands;          ///< the block's first one
  const LaneStart<Scalar>* start;  ///< of the drive; it says what was commanded before any command was sent
  double DriveCommand::* channel;  ///< of a command sent before the start
};

/// Gathers commands one by one: those that do not lie side by side, and those that were sent before the start.
template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES_APART void gather_commands(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block,
                                          const CommandSource<Scalar>& source, std::ptrdiff_t period,
                                          Scalar* gathered) {
  const std::ptrdiff_t place = static_cast<std::ptrdiff_t>(block.past_count) + period;
  for (std::size_t i = 0; i < lanes_in<L>(block); ++i) {
    if (period >= 0) {
      gathered[i] = source.commands[static_cast<std::ptrdiff_t>(i) * job.rollout_stride + period * job.period_stride];
    } else if (block.past_count == 0) {
      gathered[i] = source.start->commanded[i];
    } else {
      const DriveCommand* past = block.past + i * block.past_stride + (place > 0 ? place : 0);
      gathered[i] = static_cast<Scalar>(past->*source.channel);
    }
  }
}

/// Reads the commands that a period brings; those before the first period were sent before the start.
template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES void read_commands(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block,
                                  const CommandSource<Scalar>& source, std::ptrdiff_t period,
                                  typename L::Vector& command) {
  const std::ptrdiff_t at = period < job.last_row ? period : job.last_row;
  if (at >= 0 && block.side_by_side) {
    const Scalar* from = source.commands + at * job.period_stride;
    load(from, command);
    if constexpr (L::kLanes > 1) {
      for (std::size_t i = 0; i < L::kLanes; i += kLineBytes / sizeof(Scalar)) {
        __builtin_prefetch(from + 8 * job.period_stride + i);
      }
    }
  } else {
    alignas(64) Scalar gathered[L::kLanes] = {};
    gather_commands<L>(job, block, source, at, gathered);
    load(gathered, command);
  }
}

/// What a kernel is made for. None: every period is one part without lag. Response: gains and slow modes as well.
enum class Actuator : std::uint8_t { None, Delays, Lags, Response };

/// One channel of the drive: the input that acts, and what its lags hold.
template <class L, Actuator kActuator>
struct ChannelLanes {
  L::Vector input;
  L::Vector fast;
  std::ptrdiff_t next;  ///< the period whose command acts next
};
template <class L>
struct ChannelLanes<L, Actuator::Response> {
  L::Vector input;
  L::Vector fast;
  L::Vector slow;
  std::ptrdiff_t next;
};

/// The next command begins to act.
template <class L, Actuator kActuator, typename Scalar = L::Scalar>
SLIPWISE_LANES void tell(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block,
                         const CommandSource<Scalar>& source, ChannelLanes<L, kActuator>& channel) {
  read_commands<L>(job, block, source, channel.next, channel.input);
  ++channel.next;
}

/// Nothing, where a car only stands with turned wheels.
template <class Vector, typename Scalar>
SLIPWISE_LANES void drop_standing_speed(Scalar standing, Vector& v) {
  Vector one, zero;
  fill(Scalar{1}, one);
  fill(Scalar{0}, zero);
  v = v * sign(larger(magnitude(v) - standing, zero), one);
}

/// Curvature of twists [1/m], 0 where they stand; what is not finite stays so.
template <class Vector, typename Scalar>
SLIPWISE_LANES void find_curvature(const Vector& v, const Vector& omega, Scalar sharpest, Vector& curvature) {
  Vector one, low, high;
  fill(Scalar{1}, one);
  fill(-sharpest, low);
  fill(sharpest, high);
  const Vector moves = any_nonzero(v, v, one);
  const Vector ratio = omega / (v + (one - moves)) * moves;
  curvature = smaller(larger(ratio, low), high) + ((v - v) + (omega - omega));
}

/// The next command of a drive that steers begins to act in the channel of its curvature. Before any was sent, it is a
/// curvature already.
template <class L, Actuator kActuator, typename Scalar = L::Scalar>
SLIPWISE_LANES void tell_curvature(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block,
                                   const CommandSource<Scalar>& speed, const CommandSource<Scalar>& turn,
                                   ChannelLanes<L, kActuator>& channel) {
  typename L::Vector v, omega;
  read_commands<L>(job, block, turn, channel.next, omega);
  if (channel.next < 0 && block.past_count == 0) {
    copy(omega, channel.input);
  } else {
    read_commands<L>(job, block, speed, channel.next, v);
    find_curvature(v, omega, job.sharpest, channel.input);
  }
  ++channel.next;
}

template <class L, Actuator kActuator, typename Scalar = L::Scalar>
SLIPWISE_LANES void start_channel(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block,
                                  const CommandSource<Scalar>& source, std::ptrdiff_t shift,
                                  ChannelLanes<L, kActuator>& channel) {
  channel.next = job.start_row - shift - 1;
  tell(job, block, source, channel);
  load(source.start->fast, channel.fast);
  if constexpr (kActuator == Actuator::Response) {
    load(source.start->slow, channel.slow);
  }
}

/// The drive's mean over a part; its lags move on to the part's end. The speed goes by sums of input and output rather
/// than by the gap between them: where it passes zero it keeps its digits, which the curvature of thesis 5.1 needs
/// there.
template <class L, Actuator kActuator, bool kBySums, typename Scalar = L::Scalar>
SLIPWISE_LANES void advance(const LaneLag<Scalar>& lag, ChannelLanes<L, kActuator>& channel, typename L::Vector& mean) {
  if constexpr (kActuator == Actuator::Response) {
    mean = channel.input * lag.mean_by_input + channel.fast * lag.mean_by_fast + channel.slow * lag.mean_by_slow;
    channel.fast = channel.input * lag.fast_by_input + channel.fast * lag.fast_by_fast;
    channel.slow = channel.input * lag.slow_by_input + channel.slow * lag.slow_by_slow;
  } else if constexpr (kActuator == Actuator::Lags && !kBySums) {
    const typename L::Vector gap = channel.fast - channel.input;
    mean = channel.input + gap * lag.mean_by_fast;
    channel.fast = channel.input + gap * lag.fast_by_fast;
  } else if constexpr (kActuator == Actuator::Lags) {
    mean = channel.input * lag.mean_by_input + channel.fast * lag.mean_by_fast;
    channel.fast = channel.input * lag.fast_by_input + channel.fast * lag.fast_by_fast;
  } else {
    copy(channel.input, mean);
  }
}

}  // namespace slipwise
// NOLINTEND(modernize-avoid-c-arrays)
