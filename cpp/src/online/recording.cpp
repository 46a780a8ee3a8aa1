// SPDX-License-Identifier: Apache-2.0
// Streams merged by their stamps.
#include "slipwise/online/recording.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace slipwise {

void push_run(MotionLearner& learner, const Recording& run) {
  learner.start_run();
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  const auto stamp = [](const auto& samples, std::size_t i) { return i < samples.size() ? samples[i].t : kEnd; };
  std::size_t command = 0;
  std::size_t wheel = 0;
  std::size_t attitude = 0;
  std::size_t pose = 0;
  const std::size_t count = run.commands.size() + run.wheels.size() + run.attitudes.size() + run.poses.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double t = std::min({stamp(run.commands, command), stamp(run.wheels, wheel), stamp(run.attitudes, attitude),
                               stamp(run.poses, pose)});
    if (stamp(run.commands, command) == t) {
      learner.push_command(t, run.commands[command++].twist);
    } else if (stamp(run.wheels, wheel) == t) {
      learner.push_wheels(t, run.wheels[wheel++].twist);
    } else if (stamp(run.attitudes, attitude) == t) {
      const Attitude& tilt = run.attitudes[attitude++];
      learner.push_attitude(t, tilt.roll, tilt.pitch);
    } else {
      learner.push_pose(run.poses[pose++]);
    }
  }
}

}  // namespace slipwise
