// SPDX-License-Identifier: Apache-2.0
// Poses of a source, brought into the order of their stamps.
#include "slipwise/online/pose_source.hpp"

#include <algorithm>
#include <cmath>

#include "slipwise/online/sample_gate.hpp"

namespace slipwise {
namespace {

constexpr long kFramesApart = 1'000'000'000'000;  // numbers of frames before a break and after it are never the same

}  // namespace

std::optional<Reason> PoseSource::take(const MeasuredPose& pose) {
  const std::array numbers{pose.x, pose.y, pose.yaw, pose.std.xy, pose.std.yaw};
  StampGate gate;
  if (const auto wrong = gate.check(pose.t, numbers)) {
    return wrong;
  }
  if (!(pose.t > used)) {
    return Reason::TooLate;
  }
  const auto place = std::ranges::lower_bound(waiting, pose.t, {}, &MeasuredPose::t);
  if (place != waiting.end() && place->t == pose.t) {
    return Reason::DuplicateStamp;
  }
  if (pose.position != position_last) {
    ++breaks;
    position_last = pose.position;
  }
  MeasuredPose placed = pose;
  placed.frame += kFramesApart * breaks;
  waiting.insert(place, placed);
  return std::nullopt;
}

void PoseSource::restart() {
  gate.restart();
  timer.restart();
  waiting.clear();
  used = -std::numeric_limits<double>::infinity();
}

}  // namespace slipwise
