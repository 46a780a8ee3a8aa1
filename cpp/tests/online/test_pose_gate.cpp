// SPDX-License-Identifier: Apache-2.0
// Poses that jump: lone ones are rejected, others begin a frame, and none waits for more than three.
#include "slipwise/online/pose_gate.hpp"

#include <doctest/doctest.h>

namespace slipwise {
namespace {

constexpr double kPeriod = 0.1;

/// A robot that drives straight at 0.5 m/s.
MeasuredPose pose_at(int i) { return {.t = kPeriod * i, .x = 0.5 * kPeriod * i, .y = 0.0, .yaw = 0.0}; }

InputBuffer driven(int until) {
  InputBuffer inputs(0.5);
  for (int i = 0; i <= until; ++i) {
    inputs.push({kPeriod * i, {0.5, 0.0, 0.0}});
  }
  return inputs;
}

TEST_CASE("what waits is decided where no pose follows") {
  PoseGate gate;
  for (int i = 0; i < 40; ++i) {
    gate.push(pose_at(i), driven(i));
  }
  MeasuredPose moved = pose_at(40);
  moved.y = 3.0;
  gate.push(moved, driven(40));
  const GatedPoses found = gate.finish(driven(40));
  CHECK(found.accepted.size() == 1);
  CHECK(found.jumps.size() == 1);
}

TEST_CASE("what is decided of a pose does not depend on later inputs") {
  PoseGate gate;
  for (int i = 0; i < 40; ++i) {
    gate.push(pose_at(i), driven(i));
  }
  MeasuredPose away = pose_at(40);
  away.x += 1.6;
  PoseGate other = gate;
  InputBuffer faster = driven(40);
  faster.push({4.01, {30.0, 0.0, 0.0}});
  CHECK(gate.push(away, driven(40)).accepted.size() == other.push(away, faster).accepted.size());
}

}  // namespace
}  // namespace slipwise
