// SPDX-License-Identifier: Apache-2.0
// What a stream of measurements needs to know before it begins.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "slipwise/identify/car_curve_filter.hpp"
#include "slipwise/lie/se2.hpp"
#include "slipwise/online/learner_times.hpp"
#include "slipwise/online/pose_source.hpp"
#include "slipwise/online/segment_cutter.hpp"

namespace slipwise {

/// How measurements become segments.
struct StreamSettings {
  bool from_commands = true;          ///< motion is predicted from commands; otherwise from wheel speeds
  double segment_length = 2.5;        ///< of a learned stretch [s]
  bool whole_frames = true;           ///< a frame that is shorter is learned as one segment
  std::optional<double> stride = {};  ///< time between the starts of segments [s]; without one they are disjoint
  SegmentRules rules = {};
  double unknown_after = 0.5;                      ///< an input is unknown once it is older than this [s]
  double latency = 0.5;                            ///< streams may be late relative to each other by up to this [s]
  std::vector<double> horizons = {1.0, 2.0, 5.0};  ///< of the predictions that are held against what was measured [s]
  /// The predictions use parameters as they were known so long before their start [s]; without it, a horizon before.
  std::optional<double> embargo = {};
  Pose2 sensor = {};                 ///< where the pose sensor is known to sit in base_link
  std::optional<CarPrior> car = {};  ///< commands are throttle (v) and steering (omega) of a car
  bool heading_only = false;         ///< no poses come: turns of a gyro alone are learned from
  /// Of all sources of poses, where there are several or their fixes count; the first is sources[0].
  std::vector<SourceSettings> sources = {};

  /// From what is known until a prediction over `horizon` [s] starts.
  double age_of_known(double horizon) const { return std::max(embargo.value_or(horizon), kReady); }
};

}  // namespace slipwise
