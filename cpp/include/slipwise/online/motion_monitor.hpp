// SPDX-License-Identifier: Apache-2.0
// Whether the robot moves as the model says it must: stuck, or slipping far more than was learned.
#pragma once

#include <deque>
#include <functional>
#include <limits>
#include <optional>

#include "slipwise/online/motion_leg.hpp"
#include "slipwise/online/pose_gate.hpp"
#include "slipwise/online/pose_noise.hpp"
#include "slipwise/online/segment_cutter.hpp"

namespace slipwise {

/// How the robot moves beside what was expected of it.
struct MotionState {
  bool stuck = false;                   ///< it does not move although it must
  std::optional<double> fraction = {};  ///< of the expected motion of late; empty if too little is expected
  std::optional<double> since = {};     ///< stamp at which this was first seen [s], while stuck
};

/// Compares the motion between measured poses, over a window of 0.6 s, with what was expected from the inputs before
/// the model could learn from it. Two explanations are weighed: the robot moves as expected, with all that is unsure of
/// the model, its lag and its delay; or it moves by a fifth of that at most. A robot that moves as was expected of it a
/// moment ago is not stuck: where inputs reverse, poses that are late look like none. While the robot is stuck the
/// model of before is kept, for the learner soon takes what it sees for slip.
class MotionMonitor {
 public:
  /// The estimate at a time, what it expects of a stretch, empty without known inputs, and how fast the
  /// inputs of a stretch are [m/s, turns included].
  struct Model {
    std::function<LegKnowledge(double t)> known;
    std::function<std::optional<MotionLeg>(const LegKnowledge& known, double start, double end)> leg;
    std::function<double(double start, double end)> asked;
  };

  /// `nominal` is of poses that come without standard deviations; `late_factor` as in `SegmentRules`.
  MotionMonitor(const PoseStd& nominal, double late_factor);

  /// Another run begins.
  void restart();
  /// Takes a pose, whose stamp is later than those before.
  void push(const MeasuredPose& pose);
  /// The state at `t` [s], from the poses until `known_until`, the newest input.
  MotionState at(double t, double known_until, const Model& model);

 private:
  /// What a window says.
  enum class Finding : std::uint8_t { Unknown, Moves, Between, Stuck };

  void take(const MeasuredPose& pose, const Model& model);
  Finding judge(const MotionLeg& leg, const MeasuredPose& from, const MeasuredPose& to);
  /// Whether the window is explained by what was expected a moment before it, about as well as by a robot at rest.
  bool is_late(const LegKnowledge& known, const MeasuredPose& from, const MeasuredPose& to, const Model& model) const;
  double log_moving(const MotionLeg& leg, const MeasuredPose& from, const MeasuredPose& to) const;
  void follow(Finding finding, double t, const LegKnowledge& known);
  Eigen::Matrix3d pose_noise(const Pose2& motion) const;

  PoseStd nominal_;
  double late_factor_;
  PoseTimer timer_;
  PoseAccuracy accuracy_;
  PoseNoise noise_;
  std::deque<TimedPose> waiting_;    ///< not judged yet
  std::deque<MeasuredPose> window_;  ///< the last poses that were
  MotionState state_;
  std::optional<double> suspected_;     ///< since when windows say that the robot is stuck [s]
  double expected_ = 0.0;               ///< when motion was expected last [s]
  std::optional<LegKnowledge> before_;  ///< what was known before the robot was stuck
  double log_still_ = 0.0;              ///< of the last window that was judged, by a robot that does not move
  double asked_ = -std::numeric_limits<double>::infinity();
};

}  // namespace slipwise
