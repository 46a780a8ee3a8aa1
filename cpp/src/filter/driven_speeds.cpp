// SPDX-License-Identifier: Apache-2.0
// Percentiles of speed and yaw rate over the moving time.
#include "slipwise/filter/driven_speeds.hpp"

#include <cmath>

#include "slipwise/actuator/actuator_model.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kReferenceFraction, 0.9);  // reference speeds are the 90th percentile of those driven so far
SLIPWISE_TUNING(kLeastSpeed, 0.05);        // [m/s] and [rad/s]; slower references would make priors meaningless

}  // namespace

void DrivenSpeeds::see(const InputHistory& inputs, const Segment& segment) {
  for (const ActuatorStep& step : actuator_steps(inputs, {}, {.start = segment.start, .end = segment.end}).steps) {
    if (step.duration > 0.0) {
      speeds_.add(std::hypot(step.forward, step.left) / step.duration, step.duration);
      yaw_rates_.add(step.turn / step.duration, step.duration);
    }
  }
}

void DrivenSpeeds::begin_with(const ReferenceSpeeds& speeds, double seconds) {
  speeds_.add(speeds.v, seconds);
  yaw_rates_.add(speeds.omega, seconds);
}

ReferenceSpeeds DrivenSpeeds::reference() const {
  return {.v = speeds_.quantile(kReferenceFraction, kLeastSpeed),
          .omega = yaw_rates_.quantile(kReferenceFraction, kLeastSpeed)};
}

}  // namespace slipwise
