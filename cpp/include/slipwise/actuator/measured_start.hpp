// SPDX-License-Identifier: Apache-2.0
// What measured speeds say of the limits in front of a drive (derivations/actuator.md).
#pragma once

#include "slipwise/actuator/actuator_model.hpp"
#include "slipwise/actuator/command_limits.hpp"

namespace slipwise {

/// A start at measured speeds: which input keeps them, and until when commands act by then, by their stamps.
struct MeasuredStart {
  BodyTwist keeping;   ///< [m/s, m/s, rad/s]
  double v_until;      ///< [s]
  double omega_until;  ///< [s]
};

/// The drive did `measured` at `time` [s], in the stamps of the commands.
MeasuredStart measured_start(const ActuatorModel& actuator, double time, const BodyTwist& measured);

/// The limited history of a drive that was measured. A channel in which no command acts by then starts from what keeps
/// the measured speed. In the others a ramp that the measured speed has overtaken has come as far as that speed.
/// \throws std::invalid_argument as `check` does.
InputHistory limited_inputs(const InputHistory& commands, const CommandLimits& limits, const MeasuredStart& start,
                            double longest_piece = kRampPiece);

}  // namespace slipwise
