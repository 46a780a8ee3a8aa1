// SPDX-License-Identifier: Apache-2.0
// Shaping a manoeuvre until it ends at a goal pose: Gauss-Newton through the motion model, within bounds (Howard and
// Kelly 2007; derivations/rollouts.md).
#pragma once

#include "slipwise/planning/manoeuvre_end.hpp"

namespace slipwise {

/// Smallest and largest value of every parameter.
struct ManoeuvreBounds {
  ManoeuvreVector low;
  ManoeuvreVector high;
};

struct ReachSettings {
  double tolerance_xy = 1e-3;   ///< [m]
  double tolerance_yaw = 1e-3;  ///< [rad]
  int iterations = 8;           ///< at most, for one guess
  double turn_length = 1.0;     ///< a heading error of 1 rad weighs like this distance [m]
};

struct Reach {
  ManoeuvreVector parameters;
  Pose2 pose = {};       ///< where they lead
  double gap_xy = 0.0;   ///< distance from the goal [m]
  double gap_yaw = 0.0;  ///< [rad], without whole turns
  int linearizations = 0;
  bool reached = false;
};

/// A manoeuvre to be shaped: what stays as it is.
struct ReachProblem {
  const PlanningModel& model;
  ManoeuvreFrame frame;
  ActuatorState start;
  ManoeuvreBounds bounds;
};

/// From a guess, the smallest changes of the parameters that close the gap. The heading may differ by whole turns.
Reach reach_goal(const ReachProblem& problem, const Pose2& goal, const ManoeuvreVector& guess,
                 const ReachSettings& settings = {});

}  // namespace slipwise
