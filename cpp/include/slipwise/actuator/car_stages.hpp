// SPDX-License-Identifier: Apache-2.0
// The equations of a car commanded by throttle and steering, once for every kind of number: doubles, and lanes of
// rollouts (derivations/sensors.md).
#pragma once

#include "slipwise/actuator/car_step.hpp"
#include "slipwise/lie/lane_function.hpp"

namespace slipwise {

/// What a car does now.
template <class S>
struct CarLanes {
  S speed;     ///< [m/s]
  S steering;  ///< where the lagging steering is [-]
};

/// omega = V curvature / (1 + understeer V^2).
template <class S, typename Number>
SLIPWISE_LANES S car_yaw_rate(const S& speed, const S& curvature, Number understeer) {
  return speed * curvature / (speed * speed * understeer + Number{1});
}

/// The lag of the speed, and of the steering, over one step: lag V' = target - V (1 + cornering_drag |omega|), where
/// the yaw rate at the start is held.
/// \param functions `curvature(steering)`, `size(x)` = |x|, and `left(drag)` = exp(-duration drag / lag).
template <class S, typename Number, class Functions>
SLIPWISE_LANES CarLanes<S> advance_car(const CarStep<Number>& car, const Functions& functions, const CarLanes<S>& now,
                                       const S& target, const S& command) {
  const S omega = car_yaw_rate(now.speed, functions.curvature(now.steering), car.understeer);
  const S drag = functions.size(omega) * car.cornering_drag + Number{1};
  const S goal = target / drag;
  return {goal + (now.speed - goal) * functions.left(drag), command + (now.steering - command) * car.steering_left};
}

}  // namespace slipwise
