// SPDX-License-Identifier: Apache-2.0
// A car commanded by throttle and steering without units: static curves, a lag, drag of cornering and understeer
// (derivations/sensors.md).
#pragma once

#include <optional>
#include <vector>

#include "slipwise/actuator/input_history.hpp"
#include "slipwise/lie/body_twist.hpp"

namespace slipwise {

/// A function that is straight between its knots; beyond the last it stays level.
struct KnotCurve {
  std::vector<double> at;     ///< [K] increasing
  std::vector<double> value;  ///< [K]
  std::vector<double> std;    ///< [K] of the value

  double operator()(double x) const;
};

/// lag V' = speed(throttle) - V (1 + cornering_drag |omega|);
/// omega = V curvature(steering) / (1 + understeer V^2), steering through a lag of its own.
struct CarCurves {
  KnotCurve speed;              ///< that a throttle in [-1, 1] leads to, straight ahead [m/s]
  KnotCurve curvature;          ///< of a slow path at a steering in [-1, 1] [1/m]
  double lag = 0.0;             ///< of the speed [s]
  double steering_lag = 0.0;    ///< [s]
  double cornering_drag = 0.0;  ///< [s/rad]
  double understeer = 0.0;      ///< [s^2/m^2]
};

/// What a car does now.
struct CarState {
  double speed = 0.0;     ///< [m/s]
  double steering = 0.0;  ///< where the lagging steering is [-]

  friend bool operator==(const CarState&, const CarState&) = default;
};

/// The car after `duration` [s] under a held command (v is the throttle, omega the steering, both in [-1, 1]).
CarState advanced(const CarCurves& car, const CarState& state, const BodyTwist& command, double duration);
/// How it moves.
BodyTwist car_twist(const CarCurves& car, const CarState& state);

/// What was measured of a car at a moment. What its curves do not say of yaw rate and sideways speed dies away.
struct KnownMotion {
  double t;                   ///< [s]
  double speed;               ///< [m/s]
  double turn = 0.0;          ///< yaw rate over that of the curves [rad/s]
  double turn_lag = 0.0;      ///< with which it dies away [s]
  double sideways = 0.0;      ///< speed to the left [m/s]
  double sideways_lag = 0.0;  ///< [s]
};

/// From when to when the twists of a car are wanted, and its state at first.
struct CarSpan {
  double start;                              ///< [s]
  double end;                                ///< [s]
  std::optional<KnownMotion> measured = {};  ///< at the latest such moment before `start`
};

/// Mean twists over pieces of about a twentieth of a second, under commands of throttle and steering. Before the first
/// command the car is at rest.
InputHistory car_twists(const CarCurves& car, const InputHistory& commands, const CarSpan& span);

/// When a car does what the last of the commands leads to [s].
double settled_after(const CarCurves& car, const InputHistory& commands, double start);

}  // namespace slipwise
