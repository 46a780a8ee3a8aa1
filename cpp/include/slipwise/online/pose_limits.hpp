// SPDX-License-Identifier: Apache-2.0
// Limits of the actuator where no wheel speeds come: they show in the twists between poses.
#pragma once

#include <optional>
#include <span>

#include "slipwise/filter/motion_posterior.hpp"
#include "slipwise/hypotheses/cascaded_model.hpp"
#include "slipwise/hypotheses/motion_hypotheses.hpp"
#include "slipwise/online/actuator_limits.hpp"
#include "slipwise/segment/driven_segment.hpp"

namespace slipwise {

/// The estimate under which limits are looked for in poses.
struct PoseLimitData {
  std::span<const WheelSegment> twists;     ///< the last commands with the twists between poses that followed
  std::span<const DrivenSegment> segments;  ///< the last segments between poses
  const MotionPosterior& kept;              ///< what predicts best without limits
  const HypothesisSettings& settings;
  double wheel_separation;  ///< nominal [m]
};

/// Searches the twists for limits, learns slip, lag and delay again behind those found, and compares by segments that
/// were not learned. Empty if there are too few twists.
std::optional<ActuatorLimits> find_pose_limits(const PoseLimitData& data);

}  // namespace slipwise
