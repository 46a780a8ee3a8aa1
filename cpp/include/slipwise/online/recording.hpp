// SPDX-License-Identifier: Apache-2.0
// A recorded run, pushed through a learner as it would have come live.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "slipwise/online/motion_learner.hpp"

namespace slipwise {

/// One run, each stream in the order of its stamps.
struct Recording {
  std::vector<InputSample> commands;
  std::vector<InputSample> wheels;
  std::vector<Tilt> attitudes;
  std::vector<MeasuredPose> poses;
  std::array<std::vector<Reading>, kReadingKinds> readings = {};  ///< of each kind
  std::vector<KnownForce> forces = {};
};

/// Pushes all of it in the order of the stamps; at one stamp commands come first, poses and then readings last
/// (`Measurement`).
void push(MotionLearner& learner, const Recording& run);

/// Recorded runs as segments.
struct CutRuns {
  std::vector<DrivenSegment> segments;
  std::vector<std::size_t> run;  ///< of each segment
  std::vector<Rejected> rejected;
  std::vector<std::size_t> rejected_run;  ///< of each of these
};
/// The segments that a learner with these settings learns.
CutRuns cut_segments(const StreamSettings& settings, std::span<const Recording> runs);

/// What a learner with these settings knows of contradictions after recorded runs.
MotionEvidence motion_evidence(const StreamSettings& settings, std::span<const Recording> runs);

/// About what a car makes of each command of throttle and steering (`settings.car`): what a learner's gates see.
std::vector<std::vector<InputSample>> expected_commands(const StreamSettings& settings,
                                                        std::span<const Recording> runs);

/// The poses of a recorded run as a learner uses them: outliers rejected, frames numbered again where poses jump.
GatedPoses gate_poses(const Recording& run, double unknown_after);

}  // namespace slipwise
