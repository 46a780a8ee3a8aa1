// SPDX-License-Identifier: Apache-2.0
// Points of the path are joined by lines.
#include "slipwise/online/probed_motion.hpp"

#include <algorithm>
#include <iterator>

namespace slipwise {
namespace {

Pose2 pose_of(const StampedPose& pose) { return {pose.x, pose.y, pose.yaw}; }

Pose2 on_path(const std::vector<StampedPose>& path, double t) {
  const auto after = std::ranges::lower_bound(path, t, {}, &StampedPose::t);
  if (after == path.begin()) {
    return pose_of(path.front());
  }
  const StampedPose& from = *std::prev(after);
  const double part = (t - from.t) / (after->t - from.t);
  return {from.x + part * (after->x - from.x), from.y + part * (after->y - from.y),
          from.yaw + part * (after->yaw - from.yaw)};
}

}  // namespace

std::vector<ProbedMotion> probed_motions(const std::vector<WheelProbe>& probes, double offset) {
  std::vector<ProbedMotion> motions;
  for (const WheelProbe& probe : probes) {
    const double start = probe.first.t - offset;
    const double end = probe.last.t - offset;
    if (!probe.path.empty() && start >= probe.path.front().t && end <= probe.path.back().t) {
      motions.push_back({.measured = between(pose_of(probe.first), pose_of(probe.last)),
                         .rolled = between(on_path(probe.path, start), on_path(probe.path, end))});
    }
  }
  return motions;
}

}  // namespace slipwise
