// SPDX-License-Identifier: Apache-2.0
// From inputs to drive steps: clock offset, transport delay per channel, first-order lag per channel.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slipwise/actuator/input_track.hpp"
#include "slipwise/lie/body_twist.hpp"

namespace slipwise {

/// Parameters of the chain; all zero is the identity. vy goes the way of v.
struct CommandChain {
  double lag_v = 0.0;         ///< time constant of the speed [s]
  double lag_omega = 0.0;     ///< time constant of the yaw rate [s]
  double delay_v = 0.0;       ///< transport delay of the speed [s]
  double delay_omega = 0.0;   ///< transport delay of the yaw rate [s]
  double clock_offset = 0.0;  ///< poses are stamped this much later than the inputs [s]
};
inline constexpr Eigen::Index kChainParameters = 5;  ///< in the order of the fields above

/// A stretch of time, in pose stamps, and what is known of the drive at its start.
struct DriveWindow {
  double start;                           ///< [s]
  double end;                             ///< [s]; inputs later than this are not used
  std::optional<BodyTwist> initial = {};  ///< the drive's twist at the start, where it was measured
  double longest_step = 0.1;              ///< [s]; a lagging twist is averaged over no more than this
};

/// One step of constant mean twist: its duration and its integrals.
struct DriveStep {
  double duration;  ///< [s]
  double forward;   ///< integral of v [m]
  double left;      ///< integral of vy [m]
  double turn;      ///< integral of omega [rad]
};
/// Derivatives of (duration, forward, left, turn) by the chain's parameters.
using DriveStepJacobian = Eigen::Matrix<double, 4, kChainParameters>;

struct DriveSteps {
  std::vector<DriveStep> steps;
  std::vector<DriveStepJacobian> jacobians;  ///< empty unless asked for
};

/// The drive over [start - clock_offset, end - clock_offset] of the inputs, split wherever a delayed input changes.
DriveSteps drive_steps(const InputTrack& inputs, const CommandChain& chain, const DriveWindow& window);
/// The same with exact sensitivities to the chain's parameters.
DriveSteps linearize_drive_steps(const InputTrack& inputs, const CommandChain& chain, const DriveWindow& window);

}  // namespace slipwise
