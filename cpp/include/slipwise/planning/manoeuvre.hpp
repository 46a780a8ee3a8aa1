// SPDX-License-Identifier: Apache-2.0
// A manoeuvre: curvature and speed profiles as a few parameters, and the held commands that they stand for.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "slipwise/actuator/command_limits.hpp"
#include "slipwise/planning/curvature_spline.hpp"
#include "slipwise/planning/speed_profile.hpp"
#include "slipwise/segment/ground.hpp"

namespace slipwise {

/// The curvature's control points [1/m], then the length of the commanded path [m].
inline constexpr int kManoeuvreParameters = kCurvaturePoints + 1;
inline constexpr int kLength = kCurvaturePoints;  ///< place of the length
using ManoeuvreVector = Eigen::Matrix<double, kManoeuvreParameters, 1>;
using ManoeuvreRow = Eigen::Matrix<double, 1, kManoeuvreParameters>;

/// What does not change while a manoeuvre is shaped.
struct ManoeuvreFrame {
  SpeedEnds speeds;
  double acceleration = 0.5;  ///< [m/s^2]
  double direction = 1.0;     ///< -1 drives backwards
  int commands = 32;          ///< how many, each held for the same time
  double settling = 0.0;      ///< time under the last command after the others [s]
  /// A plane or a map under the manoeuvre, as seen from its start; level where there is none.
  std::shared_ptr<const Ground> ground = {};
};

/// One held command and its derivative by the parameters.
struct HeldCommand {
  double v = 0.0;      ///< [m/s]
  double omega = 0.0;  ///< [rad/s]
  double v_by_length = 0.0;
  ManoeuvreRow omega_by = ManoeuvreRow::Zero();
};

/// Commands from the start on; the last one goes on.
struct HeldCommands {
  ByLength period;  ///< for which each is held [s]
  std::vector<HeldCommand> commands;
  std::size_t end = 0;    ///< of these, the one that begins where the manoeuvre ends
  double settling = 0.0;  ///< time under that one [s]
};

/// The commands of a manoeuvre: the mean speed of each interval, and the curvature at its middle.
HeldCommands held_commands(const ManoeuvreFrame& frame, const ManoeuvreVector& parameters);

/// The commands behind limits of the drive, in pieces as limited_inputs cuts them. Before, `commanded` was commanded
/// for long. The manoeuvre then settles for as long as ramps take at its end, too. Where dead-band or top hold a
/// command, its derivative is zero; a ramp passes the derivative of what it goes to.
HeldCommands limited_commands(const HeldCommands& held, const CommandLimits& limits, const BodyTwist& commanded);

}  // namespace slipwise
