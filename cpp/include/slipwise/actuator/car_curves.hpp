// SPDX-License-Identifier: Apache-2.0
// A car commanded by throttle and steering without units: static curves, a lag, drag of cornering and understeer
// (derivations/sensors.md).
#pragma once

#include <Eigen/Core>
#include <memory>
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

/// How sure the numbers of a car are, in the order of `car_numbers`.
struct CarSpread {
  Eigen::MatrixXd covariance;  ///< [numbers, numbers]
  Eigen::VectorXd prior_std;   ///< [numbers] before it drove; 0 where it is not stated
};

/// lag V' = speed(throttle) - V (1 + cornering_drag |omega|);
/// omega = V curvature(steering) / (1 + understeer V^2), steering through a lag of its own. Both reach it `delay` late.
struct CarCurves {
  KnotCurve speed;              ///< that a throttle in [-1, 1] leads to, straight ahead [m/s]
  KnotCurve curvature;          ///< of a slow path at a steering in [-1, 1] [1/m]
  double lag = 0.0;             ///< of the speed [s]
  double steering_lag = 0.0;    ///< [s]
  double cornering_drag = 0.0;  ///< [s/rad]
  double understeer = 0.0;      ///< [s^2/m^2]
  double delay = 0.0;           ///< of throttle and steering [s]
  /// Without it the numbers are taken as exact.
  std::shared_ptr<const CarSpread> spread = {};
};

/// All numbers of a car: speed and curvature at the knots, lag, steering lag, drag of cornering, understeer, delay.
Eigen::VectorXd car_numbers(const CarCurves& car);

/// What inputs may be instead of what they are expected to be, along each direction of their uncertainty.
struct InputSpread {
  std::vector<InputHistory> deviated;
  double step = 1.0;  ///< of a deviation, in standard deviations
};

/// A car's deviations of `InputSpread::step` standard deviations, along independent directions that matter under these
/// commands (v is the throttle, omega the steering). They are of what the car never showed, which is the prior's part
/// of the covariance: what noise leaves of the rest is in the errors of predictions, by which these are judged.
struct CarDeviations {
  std::vector<CarCurves> cars;
  double step = 1.0;
};
CarDeviations car_deviations(const CarCurves& car, const InputHistory& commands);

/// What a car does now.
struct CarState {
  double speed = 0.0;     ///< [m/s]
  double steering = 0.0;  ///< where the lagging steering is [-]

  friend bool operator==(const CarState&, const CarState&) = default;
};

/// The car after `duration` [s] under a held command that has reached it (v is the throttle, omega the steering, both
/// in
/// [-1, 1]).
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
