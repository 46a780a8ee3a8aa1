// SPDX-License-Identifier: Apache-2.0
// The whole motion model on plain columns of floats, for controllers that hold velocities, such as Nav2's MPPI.
#pragma once

#include <cstddef>
#include <span>

#include "slipwise/rollout/rollout_batch.hpp"

namespace slipwise::planning {

/// Commands of `rollouts` sequences over `periods`: that of rollout n over period k stands at [k * rollouts + n]. The
/// first is sent now, at the start of period 0.
struct CommandColumns {
  const float* v;      ///< [m/s]
  const float* omega;  ///< [rad/s]
  std::size_t rollouts;
  std::size_t periods;
  const float* vy = nullptr;  ///< [m/s], of a program that drives sideways
};

/// What the drive is about to do.
struct ColumnStart {
  DriveCommand drive;  ///< what it does now
  /// Commands sent before, one period apart, the oldest first; those still in the delay act first.
  std::span<const DriveCommand> in_flight = {};
};

/// What the robot does over the periods, in the same places. Velocities are of the robot's frame at a period's start,
/// such that the sum of `vx, vy` turned by the heading before the period, and of `wz`, times the period, is the path:
/// x_k = x_(k-1) + (vx_k cos(yaw_(k-1)) - vy_k sin(yaw_(k-1))) dt and yaw_k = yaw_(k-1) + wz_k dt, exactly.
struct VelocityColumns {
  float* vx;  ///< forward [m/s]
  float* vy;  ///< to the left [m/s]
  float* wz;  ///< [rad/s]
};

/// Drives the commands through delay, limits, lags and slip of `program` and writes the velocities.
/// \throws std::invalid_argument when there is nothing to drive, or a number is not finite; as `rollout_batch`.
void predict_columns(const RolloutProgram& program, const CommandColumns& commands, const ColumnStart& start,
                     const VelocityColumns& velocities, const RolloutOptions& options = {});

}  // namespace slipwise::planning
