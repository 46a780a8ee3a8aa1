// SPDX-License-Identifier: Apache-2.0
// The commands of a block behind the limits of the drive: what was given before the start, then piece by piece.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "slipwise/actuator/command_limiter.hpp"
#include "slipwise/rollout/lane_job.hpp"
#include "slipwise/rollout/rollout_program.hpp"

namespace slipwise {

/// The limits at a start, and the pieces that they gave before it.
struct LimitedStart {
  CommandLimiter limiter;
  std::vector<DriveCommand> given;  ///< the oldest first; what is older equals it

  /// Piece i, counted from the start on; it is before the start.
  const DriveCommand& at(std::ptrdiff_t i) const {
    return given[static_cast<std::size_t>(std::max(static_cast<std::ptrdiff_t>(given.size()) + i, std::ptrdiff_t{0}))];
  }
};

/// Adds the pieces of one more command.
void add_pieces(const RolloutProgram& program, const DriveCommand& command, LimitedStart& start);

/// `past` was commanded before the start, and the oldest of it for long. Without any, the limits give what keeps the
/// drive as it is, `commanded`.
LimitedStart limited_start(const RolloutProgram& program, std::span<const DriveCommand> past,
                           const DriveCommand& commanded);

/// Memory for the limited commands of one block at a time.
template <typename Scalar>
class LimitedCommands {
 public:
  /// `job` holds the commands as they are given.
  LimitedCommands(const RolloutProgram& program, const LaneKernelOfLevel<Scalar>& kernel, const LaneJob<Scalar>& job)
      : kernel_(kernel), given_(job), driven_(job) {
    if (!program.limited()) {
      return;
    }
    before_ = static_cast<std::size_t>(std::max({job.shift_v, job.shift_omega, std::ptrdiff_t{0}})) + 1;
    const std::ptrdiff_t early = std::max(-std::min(job.shift_v, job.shift_omega), std::ptrdiff_t{0});
    periods_ = job.periods + static_cast<std::size_t>(early);  // a ramp may go on after the last command has begun
    const std::size_t rows = before_ + periods_ * job.pieces;
    v_.resize(rows * kernel.lanes);
    omega_.resize(rows * kernel.lanes);
    if (job.vy != nullptr) {
      vy_.resize(rows * kernel.lanes);
      driven_.vy = vy_.data();
    }
    driven_.v = v_.data();
    driven_.omega = omega_.data();
    driven_.rollout_stride = 0;
    driven_.period_stride = static_cast<std::ptrdiff_t>(kernel.lanes);
    driven_.start_row = static_cast<std::ptrdiff_t>(before_);
    driven_.last_row = static_cast<std::ptrdiff_t>(rows) - 1;
    driven_.periods = job.periods * job.pieces;
  }

  /// Where a lane starts.
  void set_start(std::size_t lane, const LimitedStart& start) {
    const auto state = start.limiter.state();
    start_.speed[lane] = static_cast<Scalar>(state[0]);
    start_.yaw_rate[lane] = static_cast<Scalar>(state[1]);
    start_.left[lane] = static_cast<Scalar>(state[2]);
    start_.right[lane] = static_cast<Scalar>(state[3]);
    for (std::size_t row = 0; row < before_ && lane < kernel_.lanes; ++row) {
      const DriveCommand& given = start.at(static_cast<std::ptrdiff_t>(row) - static_cast<std::ptrdiff_t>(before_));
      v_[row * kernel_.lanes + lane] = static_cast<Scalar>(given.v);
      omega_[row * kernel_.lanes + lane] = static_cast<Scalar>(given.omega);
      if (!vy_.empty()) {
        vy_[row * kernel_.lanes + lane] = static_cast<Scalar>(given.vy);
      }
    }
  }

  /// Drives one block; its commands lie side by side once they are limited.
  unsigned roll(LaneBlock<Scalar>& block) {
    if (given_.limits != nullptr) {
      const std::size_t first = before_ * kernel_.lanes;
      kernel_.limit(given_, block, start_,
                    {v_.data() + first, omega_.data() + first, vy_.empty() ? nullptr : vy_.data() + first, periods_});
      block.side_by_side = true;
    }
    return kernel_.roll(driven_, block);
  }

 private:
  LaneKernelOfLevel<Scalar> kernel_;
  const LaneJob<Scalar>& given_;
  LaneJob<Scalar> driven_;
  std::size_t before_ = 0;              ///< rows before the start
  std::size_t periods_ = 0;             ///< from the start on
  std::vector<Scalar> v_, omega_, vy_;  ///< [rows, lanes]
  RampStart<Scalar> start_{};
};

}  // namespace slipwise
