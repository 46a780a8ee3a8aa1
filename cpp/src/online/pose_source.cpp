// SPDX-License-Identifier: Apache-2.0
// Poses of a source, brought into the order of their stamps.
#include "slipwise/online/pose_source.hpp"

#include <algorithm>
#include <cmath>

#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/sample_gate.hpp"

namespace slipwise {
namespace {

constexpr long kFramesApart = 1'000'000'000'000;  // numbers of frames before a break and after it are never the same

}  // namespace

std::optional<Reason> PoseSource::take(const MeasuredPose& pose) {
  const std::array numbers{pose.x, pose.y, pose.yaw, pose.std.xy, pose.std.yaw};
  StampGate stamps;
  if (const auto wrong = stamps.check(pose.t, numbers)) {
    return wrong;
  }
  if (!later(pose.t, used)) {
    return Reason::TooLate;
  }
  const auto same = std::ranges::lower_bound(waiting, pose.t - kSameStamp, {}, &MeasuredPose::t);
  if (same != waiting.end() && same_stamp(same->t, pose.t)) {
    return Reason::DuplicateStamp;
  }
  if (pose.position != position_last) {
    ++breaks;
    position_last = pose.position;
  }
  MeasuredPose placed = pose;
  placed.frame += kFramesApart * breaks;
  waiting.insert(std::ranges::lower_bound(waiting, pose.t, {}, &MeasuredPose::t), placed);
  return std::nullopt;
}

void PoseSource::restart() {
  gate.restart();
  timer.restart();
  waiting.clear();
  used = -std::numeric_limits<double>::infinity();
}

}  // namespace slipwise
