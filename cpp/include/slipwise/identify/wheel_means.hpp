// SPDX-License-Identifier: Apache-2.0
// Wheel speeds as means over short intervals, each of which is one measurement of the drive.
#pragma once

#include <vector>

#include "slipwise/actuator/input_history.hpp"

namespace slipwise {

/// A stretch of wheel speeds, held between samples as everywhere.
struct WheelMeans {
  std::vector<double> edges;     ///< [K + 1] of the intervals, in input stamps [s]
  std::vector<double> samples;   ///< [K] how many wheel speeds each interval holds
  std::vector<BodyTwist> twist;  ///< [K] their mean over it
};

/// The intervals end where wheel speeds are stamped, so that no two share a sample, and last `shortest` [s] at least
/// or one sample. \throws std::invalid_argument when the stretch does not end after it starts.
WheelMeans wheel_means(const InputHistory& wheels, double start, double end, double shortest);

}  // namespace slipwise
