// SPDX-License-Identifier: Apache-2.0
// Twists of short segments between poses, joined until they are long enough.
#include "slipwise/online/pose_twists.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kMeanTime = 0.2;         // [s] between the poses of a twist; shorter, noise of poses hides the motion
constexpr double kLongestMeanTime = 0.3;  // [s]; over longer ones, a ramp that they blur passes for one of the actuator
constexpr double kStretch = 1.0;          // [s] from which on a stretch is complete

/// A robot that stands still although it is commanded to move tells of a dead band.
SegmentRules with_still(SegmentRules rules) {
  rules.still_speed = -1.0;
  return rules;
}

}  // namespace

PoseTwists::PoseTwists(const SegmentRules& rules, const Pose2& sensor)
    : sensor_(sensor), cutter_(kMeanTime, with_still(rules), false) {}

std::vector<TwistStretch> PoseTwists::push(const TimedPose& pose, const InputBuffer& commands) {
  return joined(cutter_.push(pose, commands));
}

std::vector<TwistStretch> PoseTwists::finish(const InputBuffer& commands) {
  std::vector<TwistStretch> out = joined(cutter_.finish(commands));
  close(out);
  return out;
}

double PoseTwists::begins() const { return stretch_ ? std::min(stretch_->start, cutter_.begins()) : cutter_.begins(); }

std::vector<TwistStretch> PoseTwists::joined(const std::vector<SegmentCut>& cuts) {
  std::vector<TwistStretch> out;
  for (const SegmentCut& cut : cuts) {
    const double seconds = cut.second.t - cut.first.t;
    if (stretch_ && !same_stamp(cut.first.t, stretch_->end)) {
      close(out);
    }
    if (cut.rejected || later(seconds, kLongestMeanTime)) {
      close(out);
      continue;
    }
    TwistStretch& stretch = stretch_ ? *stretch_ : stretch_.emplace(TwistStretch{.start = cut.first.t});
    const Eigen::Vector3d twist = adjoint(sensor_) * log(cut.measured()) / seconds;
    stretch.t.push_back(cut.first.t + 0.5 * seconds);
    stretch.twist.push_back({.v = twist.x(), .vy = twist.y(), .omega = twist.z()});
    stretch.end = cut.second.t;
    if (!later(kStretch, stretch.end - stretch.start)) {
      close(out);
    }
  }
  return out;
}

void PoseTwists::close(std::vector<TwistStretch>& out) {
  if (stretch_) {
    out.push_back(std::move(*stretch_));
    stretch_.reset();
  }
}

}  // namespace slipwise
