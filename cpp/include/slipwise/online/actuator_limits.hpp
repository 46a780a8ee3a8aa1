// SPDX-License-Identifier: Apache-2.0
// Dead band, saturation and slew rates of the actuator, looked for when asked: off the path of measurements.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "slipwise/filter/causal_filter.hpp"
#include "slipwise/filter/motion_posterior.hpp"
#include "slipwise/hypotheses/cascaded_model.hpp"
#include "slipwise/identify/limit_search.hpp"
#include "slipwise/segment/driven_segment.hpp"

namespace slipwise {

/// The estimate under which limits are looked for.
struct LimitData {
  std::span<const WheelSegment> wheels;     ///< the last commands with the wheel speeds that followed
  std::span<const DrivenSegment> segments;  ///< the last segments between poses, driven by commands
  const MotionPosterior& cascaded;          ///< what was learned without limits from wheel speeds
  const MotionPosterior& kept;              ///< what predicts best without limits
  const CausalFilterSettings& filter;
  double wheel_separation;  ///< nominal [m]
};

/// What a search for limits found.
struct ActuatorLimits {
  LimitSearch search;
  /// The estimate behind the limits; empty if none were found, or if they do not predict better.
  std::shared_ptr<const MotionPosterior> posterior;
  double score;  ///< log score of segments that were not learned, over that without limits
};

/// Searches the wheel speeds for limits, learns the actuator model again behind those found, and compares both by
/// segments of poses that end after the data of the limits. Empty if there are too few wheel speeds.
std::optional<ActuatorLimits> find_actuator_limits(const LimitData& data);

/// The limits that the twists of stretches show; empty if there are too few twists.
std::optional<LimitSearch> search_limits(std::span<const WheelSegment> driven, const PriorSettings& prior,
                                         double wheel_separation);

/// Commands and wheel speeds as the search takes them: stretches without a gap, a twist in each twentieth of a second.
std::vector<WheelRecord> drive_records(std::span<const WheelSegment> wheels);

}  // namespace slipwise
