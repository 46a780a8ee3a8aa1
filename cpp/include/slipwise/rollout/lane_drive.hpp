// SPDX-License-Identifier: Apache-2.0
// The command chain in lanes: which command acts now, and what the drive makes of it.
#pragma once

#include "slipwise/rollout/lane_job.hpp"
#include "slipwise/rollout/lanes.hpp"

namespace slipwise {

/// Reads the commands of one channel for a block, period after period.
template <class L, typename Scalar>
struct CommandLanes {
  const LaneJob<Scalar>& job;
  const LaneBlock<Scalar>& block;
  const Scalar* commands;          ///< of all rollouts
  const Scalar* drive;             ///< the drive's twist at the start, for when no command was sent yet
  double DriveCommand::* channel;  ///< of a command sent before the start
  bool side_by_side;               ///< a period's commands can be read as they lie

  SLIPWISE_LANES void read(std::ptrdiff_t period, typename L::Row& row) const {
    const auto last = static_cast<std::ptrdiff_t>(job.periods) - 1;
    const std::ptrdiff_t at = period < last ? period : last;
    if (at < 0) {
      read_past(at, row);
      return;
    }
    const Scalar* from =
        commands + static_cast<std::ptrdiff_t>(block.first) * job.rollout_stride + at * job.period_stride;
    if (side_by_side) {
#pragma GCC unroll 8
      for (std::size_t u = 0; u < L::kVectors; ++u) {
        load(from + u * L::kWidth, row.part[u]);
        __builtin_prefetch(from + 8 * job.period_stride + u * L::kWidth);
      }
      return;
    }
    alignas(64) Scalar gathered[L::kLanes] = {};
    for (std::size_t i = 0; i < block.count; ++i) {
      gathered[i] = from[static_cast<std::ptrdiff_t>(i) * job.rollout_stride];
    }
    load_row(gathered, row);
  }

 private:
  /// Commands from before the start: `period` is negative.
  SLIPWISE_LANES void read_past(std::ptrdiff_t period, typename L::Row& row) const {
    if (block.past_count == 0) {
      load_row(drive, row);
      return;
    }
    const std::ptrdiff_t back = static_cast<std::ptrdiff_t>(block.past_count) + period;
    const std::size_t at = static_cast<std::size_t>(back > 0 ? back : 0);
    alignas(64) Scalar gathered[L::kLanes] = {};
    for (std::size_t i = 0; i < block.count; ++i) {
      gathered[i] = static_cast<Scalar>(block.past[i * block.past_stride + at].*channel);
    }
    load_row(gathered, row);
  }

 public:
  SLIPWISE_LANES static void load_row(const Scalar* from, typename L::Row& row) {
#pragma GCC unroll 8
    for (std::size_t u = 0; u < L::kVectors; ++u) {
      load(from + u * L::kWidth, row.part[u]);
    }
  }
};

/// One channel of the drive: the command that acts, and the lag's output.
template <class L, typename Scalar>
struct ChannelLanes {
  CommandLanes<L, Scalar> commands;
  std::ptrdiff_t next;  ///< the period whose command acts next
  typename L::Row input;
  typename L::Row output;

  SLIPWISE_LANES ChannelLanes(const CommandLanes<L, Scalar>& from, std::ptrdiff_t shift)
      : commands(from), next(-shift) {
    commands.read(next - 1, input);
    CommandLanes<L, Scalar>::load_row(commands.drive, output);
  }

  /// The channel's mean over a part of the period, which ends with the lag's output moved on.
  template <bool kLags>
  SLIPWISE_LANES void advance(bool takes_next, Scalar mean_gap, Scalar end_gap, typename L::Row& mean) {
    if (takes_next) {
      commands.read(next, input);
      ++next;
    }
    if constexpr (!kLags) {
      mean = input;
      return;
    }
#pragma GCC unroll 8
    for (std::size_t u = 0; u < L::kVectors; ++u) {
      const auto gap = output.part[u] - input.part[u];
      mean.part[u] = input.part[u] + gap * mean_gap;
      output.part[u] = input.part[u] + gap * end_gap;
    }
  }
};

}  // namespace slipwise
