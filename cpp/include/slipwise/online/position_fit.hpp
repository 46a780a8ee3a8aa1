// SPDX-License-Identifier: Apache-2.0
// The motion over a stretch that all its positions tell: the way that the inputs make, fitted to them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slipwise/online/input_buffer.hpp"
#include "slipwise/online/pose_gate.hpp"
#include "slipwise/sensor/position_sensor.hpp"

namespace slipwise {

struct FittedPositions {
  PositionSensor sensor;
  Eigen::Vector3d z;  ///< what it measured: x, y and the turn
  double heading;     ///< at the start, in the frame of the positions [rad]
  double std;         ///< of one position of usual noise, as they scatter about the way [m]
};

/// Fits the way from the first position until `end` [s]: where it begins and heads, by which factor it is longer and
/// turns more than the inputs say, and how much it turns per way. The inputs are known until `end`. Empty where the
/// robot hardly moved, or not as the inputs say: then nothing tells where it headed.
std::optional<FittedPositions> fit_positions(const std::vector<MeasuredPose>& positions, double end,
                                             const InputBuffer& inputs, const Pose2& place);

}  // namespace slipwise
