// SPDX-License-Identifier: Apache-2.0
// Motions between pairs of poses beside those of the wheels' path, the clocks being some time apart.
#pragma once

#include <vector>

#include "slipwise/lie/se2.hpp"
#include "slipwise/online/wheel_probe.hpp"

namespace slipwise {

/// The second pose seen from the first.
struct ProbedMotion {
  Pose2 measured;
  Pose2 rolled;  ///< by the wheels
};

/// Motions of the pairs whose stamps are within the path where the wheels' clock is `offset` [s] behind.
std::vector<ProbedMotion> probed_motions(const std::vector<WheelProbe>& probes, double offset);

}  // namespace slipwise
