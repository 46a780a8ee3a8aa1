// SPDX-License-Identifier: Apache-2.0
// A recorded run, pushed through a learner as it would have come live.
#pragma once

#include <vector>

#include "slipwise/online/motion_learner.hpp"

namespace slipwise {

/// Roll and pitch at a stamp.
struct Attitude {
  double t;      ///< [s]
  double roll;   ///< [rad]
  double pitch;  ///< [rad]
};

/// One run, each stream in the order of its stamps.
struct Recording {
  std::vector<InputSample> commands;
  std::vector<InputSample> wheels;
  std::vector<Attitude> attitudes;
  std::vector<MeasuredPose> poses;
};

/// Starts a run and pushes all of it in the order of the stamps; at one stamp commands come first, poses last.
void push_run(MotionLearner& learner, const Recording& run);

}  // namespace slipwise
