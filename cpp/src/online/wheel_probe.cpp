// SPDX-License-Identifier: Apache-2.0
// Each pose is paired with the first one a second later.
#include "slipwise/online/wheel_probe.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kLength = 1.0;         // [s] between the poses
constexpr double kLongestProbe = 1.6;   // [s]
constexpr double kClocksTried = 0.3;    // [s] the clocks of poses and wheels are tried apart by at most this
constexpr double kMoving = 0.05;        // [m] by the wheels
constexpr double kPointsApart = 0.004;  // [s] between points of the path at least
constexpr std::size_t kMostProbes = 128;
constexpr double kRecentApart = 2.0;  // [s] from one of the last pairs to the next
constexpr std::size_t kMostRecent = 60;

/// Up to the last sample until `end`: which ones came after it must not matter.
std::vector<StampedPose> path_of(double start, double end, const InputBuffer& wheels) {
  std::vector<StampedPose> path;
  Pose2 pose;
  double t = std::max(start, wheels.first());
  path.push_back({.t = t, .x = 0.0, .y = 0.0, .yaw = 0.0});
  for (auto next = wheels.first_after(t); next && !later(*next, end); next = wheels.first_after(*next)) {
    if (!later(t + kPointsApart, *next)) {
      pose = compose(pose, wheels.reckoned(t, *next));
      t = *next;
      path.push_back({.t = t, .x = pose.x, .y = pose.y, .yaw = pose.theta});
    }
  }
  return path;
}

}  // namespace

void ProbeCutter::start_run() {
  open_.clear();
  waiting_.clear();
  recent_until_.reset();
}

void ProbeCutter::end_run(const InputBuffer& wheels) {
  for (; !waiting_.empty(); waiting_.pop_front()) {
    keep(waiting_.front(), wheels);
  }
  open_.clear();
}

void ProbeCutter::push(const MeasuredPose& pose, const InputBuffer& wheels) {
  if (wheels.empty() || later(wheels.first(), pose.t) || pose.position) {
    return;
  }
  while (!waiting_.empty() && later(pose.t, waiting_.front().probe.last.t + kClocksTried)) {
    keep(waiting_.front(), wheels);
    waiting_.pop_front();
  }
  if (open_.empty() || frame_ != pose.frame) {
    open_.clear();
    frame_ = pose.frame;
  }
  const StampedPose seen{.t = pose.t, .x = pose.x, .y = pose.y, .yaw = pose.yaw};
  for (; !open_.empty() && !later(open_.front().t + kLength, seen.t); open_.pop_front()) {
    const StampedPose& first = open_.front();
    const HeldMotion rolled = wheels.held_motion(first.t, seen.t);
    if (seen.t - first.t >= kLongestProbe - kSameStamp || std::hypot(rolled.forward, rolled.sideways) <= kMoving) {
      continue;
    }
    const bool spread = ++passed_ >= every_;
    const bool recent = !recent_until_ || !later(*recent_until_, first.t);
    passed_ = spread ? 0 : passed_;
    recent_until_ = recent ? first.t + kRecentApart : recent_until_;
    if (spread || recent) {
      waiting_.push_back({.probe = {.first = first, .last = seen, .path = {}}, .spread = spread, .recent = recent});
    }
  }
  open_.push_back(seen);
}

/// Where there are too many, every other one goes, and fewer are kept from then on.
void ProbeCutter::keep(Waiting waiting, const InputBuffer& wheels) {
  WheelProbe& probe = waiting.probe;
  probe.path = path_of(probe.first.t - kClocksTried, probe.last.t + kClocksTried, wheels);
  if (waiting.recent) {
    recent_.push_back(probe);
    if (recent_.size() > kMostRecent) {
      recent_.erase(recent_.begin());
    }
  }
  if (waiting.spread) {
    probes_.push_back(std::move(probe));
  }
  if (probes_.size() < 2 * kMostProbes) {
    return;
  }
  std::vector<WheelProbe> half;
  for (std::size_t i = 0; i < probes_.size(); i += 2) {
    half.push_back(std::move(probes_[i]));
  }
  probes_ = std::move(half);
  every_ *= 2;
}

}  // namespace slipwise
