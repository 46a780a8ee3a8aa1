// SPDX-License-Identifier: Apache-2.0
// Commands that bring the robot to a goal pose, through the learned motion model (thesis 8.4).
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "slipwise/planning/manoeuvre_table.hpp"

namespace slipwise {

struct TrajectorySettings {
  double cruise = 1.0;          ///< speed between the ramps [m/s]
  double end_speed = 0.0;       ///< commanded at the goal; 0 waits until the robot has come to rest [m/s]
  double rest_speed = 0.02;     ///< no faster counts as rest [m/s]
  double rest_yaw_rate = 0.02;  ///< no faster counts as rest [rad/s]
  double longest = 10.0;        ///< of commanded paths [m]
  bool backwards = false;       ///< drive backwards all the way
  bool straight_end = false;    ///< the last command has no curvature, so that another manoeuvre can follow
  int commands = 32;            ///< each held for the same time
  int samples = 10000;          ///< of the table of first guesses
  int guesses = 12;             ///< tried at most
  ReachSettings reach = {};     ///< tolerances

  /// \throws std::invalid_argument unless all are positive, finite, and within the limits.
  void check(const DriveLimits& limits) const;
};

enum class TrajectoryStatus : std::uint8_t { Reached, TooFar, Unreachable };
/// What the status means and what to do about it; ends without a full stop.
std::string_view advice(TrajectoryStatus status);

/// Commands from the start on, each held until the next and the last one on; the path that they cause.
struct Trajectory {
  TrajectoryStatus status = TrajectoryStatus::Unreachable;
  std::vector<double> t = {};      ///< [commands + 1], when each is given [s]
  std::vector<double> v = {};      ///< [m/s]
  std::vector<double> omega = {};  ///< [rad/s]
  ManoeuvrePath path = {};         ///< observed from the start; it ends when the robot is at the goal
  double gap_xy = 0.0;             ///< how far the end is from the goal [m]
  double gap_yaw = 0.0;            ///< [rad]
  int linearizations = 0;          ///< how often the model was linearised
};

/// Plans to goals from states near the one that its table is made for.
class TrajectoryPlanner {
 public:
  /// \throws std::invalid_argument when limits, settings or start make no sense.
  TrajectoryPlanner(PlanningModel model, const DriveLimits& limits, const TrajectorySettings& settings,
                    const ActuatorState& start = {});

  /// A manoeuvre to `goal`, observed from the robot, over a plane or a map as the robot sees it, level where there is
  /// none. Without a manoeuvre the status says so, and the nearest attempt is returned.
  /// \throws std::invalid_argument when goal or start are not finite, the start is faster than the limits, or the
  /// ground is an attitude that was measured.
  Trajectory to(const Pose2& goal, const ActuatorState& start, const std::shared_ptr<const Ground>& ground = {}) const;

  /// Bounds and frame of all manoeuvres from a start; `cruise` [m/s] is what the settings say, or slower.
  ReachProblem problem(const ActuatorState& start, double cruise) const;
  const TrajectorySettings& settings() const { return settings_; }

 private:
  PlanningModel model_;
  DriveLimits limits_;
  TrajectorySettings settings_;
  ManoeuvreTable table_;
};

}  // namespace slipwise
