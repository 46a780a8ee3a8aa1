// SPDX-License-Identifier: Apache-2.0
// The command chain in lanes: which command acts now, and what the drive makes of it.
#pragma once

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
  const Scalar* drive;             ///< the drive's twist at the start, for when no command was sent yet
  double DriveCommand::* channel;  ///< of a command sent before the start
};

/// Gathers commands one by one: those that do not lie side by side, and those that were sent before the start.
template <class L, typename Scalar = L::Scalar>
[[gnu::noinline]] void gather_commands(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block,
                                       const CommandSource<Scalar>& source, std::ptrdiff_t period, Scalar* gathered) {
  const std::ptrdiff_t place = static_cast<std::ptrdiff_t>(block.past_count) + period;
  for (std::size_t i = 0; i < block.count; ++i) {
    if (period >= 0) {
      gathered[i] = source.commands[static_cast<std::ptrdiff_t>(i) * job.rollout_stride + period * job.period_stride];
    } else if (block.past_count == 0) {
      gathered[i] = source.drive[i];
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
  const auto last = static_cast<std::ptrdiff_t>(job.periods) - 1;
  const std::ptrdiff_t at = period < last ? period : last;
  if (at >= 0 && block.side_by_side) {
    const Scalar* from = source.commands + at * job.period_stride;
    load(from, command);
    for (std::size_t i = 0; i < L::kLanes; i += kLineBytes / sizeof(Scalar)) {
      __builtin_prefetch(from + 8 * job.period_stride + i);
    }
  } else {
    alignas(64) Scalar gathered[L::kLanes] = {};
    gather_commands<L>(job, block, source, at, gathered);
    load(gathered, command);
  }
}

/// A drive channel's lag over a part: the mean over the part, and the output moved on to its end.
template <bool kLags, typename Scalar, class Vector>
SLIPWISE_LANES void advance_lag(const Vector& input, Scalar mean_gap, Scalar end_gap, Vector& output, Vector& mean) {
  if constexpr (kLags) {
    const Vector gap = output - input;
    mean = input + gap * mean_gap;
    output = input + gap * end_gap;
  } else {
    copy(input, mean);
  }
}

/// One channel of the drive: the command that acts, and the lag's output.
template <class L>
struct ChannelLanes {
  L::Vector input;
  L::Vector output;
  std::ptrdiff_t next;  ///< the period whose command acts next
};

template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES void start_channel(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block,
                                  const CommandSource<Scalar>& source, std::ptrdiff_t shift, ChannelLanes<L>& channel) {
  channel.next = -shift;
  load(source.drive, channel.output);
  read_commands<L>(job, block, source, channel.next - 1, channel.input);
}

}  // namespace slipwise
// NOLINTEND(modernize-avoid-c-arrays)
