// SPDX-License-Identifier: Apache-2.0
// What sensors look at along a path: the poses at their moments, at which steps are cut.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "slipwise/actuator/actuator_model.hpp"
#include "slipwise/lie/se2.hpp"
#include "slipwise/segment/segment.hpp"
#include "slipwise/sensor/sensor.hpp"

namespace slipwise {

/// What one sensor looks at.
struct Sight {
  Moments stamps = {};
  std::array<std::size_t, kMostMoments> at = {};  ///< places of the poses then, as many as there are moments

  std::array<Pose2, kMostMoments> robot(const std::vector<Pose2>& poses) const;
};

/// The sights of a segment's sensors on a path of these steps. Cuts the steps at moments inside them, which are fixed,
/// whatever the actuator does.
std::vector<Sight> cut_for_sights(ActuatorSteps& drive, const Segment& segment);
/// Those of a path up to one of its poses, for sensors that look at nothing between start and end.
std::vector<Sight> sights_until(std::size_t last, const Segment& segment);

}  // namespace slipwise
