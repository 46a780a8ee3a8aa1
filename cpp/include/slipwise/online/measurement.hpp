// SPDX-License-Identifier: Apache-2.0
// What is measured of a robot, or commanded: one of a few kinds, each with its stamp.
#pragma once

#include <variant>

#include "slipwise/linear/takes.hpp"
#include "slipwise/online/force_buffer.hpp"
#include "slipwise/online/input_buffer.hpp"
#include "slipwise/online/pose_gate.hpp"
#include "slipwise/online/reading.hpp"
#include "slipwise/segment/ground.hpp"

namespace slipwise {

/// Of a car (`StreamSettings::car`) v is the throttle and omega the steering.
struct CommandSample {
  InputSample sample;
};

/// The twist that the wheels measure.
struct WheelSample {
  InputSample sample;
};

/// At one stamp, in this order: what was commanded, and what moved and pushed the robot, come before where it was.
using Measurement = std::variant<CommandSample, WheelSample, KnownForce, Tilt, MeasuredPose, Reading>;

/// Its stamp [s].
inline double& stamp_of(Measurement& measurement) {
  return std::visit(Takes{[](CommandSample& command) -> double& { return command.sample.t; },
                          [](WheelSample& wheels) -> double& { return wheels.sample.t; },
                          [](auto& other) -> double& { return other.t; }},
                    measurement);
}

}  // namespace slipwise
