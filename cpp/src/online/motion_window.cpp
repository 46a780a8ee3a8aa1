// SPDX-License-Identifier: Apache-2.0
// Windows begin at the first pose of each 1.5 s of a frame.
#include "slipwise/online/motion_window.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slipwise/linear/present.hpp"
#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kLength = 1.5;             // [s]
constexpr double kLongestWindow = 4.0;      // [s] poses may be missing for a while
constexpr double kInputsKnown = 0.9;        // of a window's time, inputs must be known
constexpr double kChord = 0.1;              // [m] from one position to the next that tells a course
constexpr std::size_t kMostWindows = 4000;  // a hundred minutes
constexpr double kWholeTurn = 2.0 * std::numbers::pi;
constexpr double kDriven = 0.05;          // [m] by the inputs; slower ones may be inside a dead band
constexpr double kTurnArm = 0.3;          // [m] at which a turn counts as distance
constexpr double kRecentDriving = 120.0;  // [s] of driving

double motion_of(const HeldMotion& held) {
  return std::hypot(held.forward, held.sideways) + kTurnArm * std::abs(held.rotation);
}

}  // namespace

double within_half_turn(double angle, double turn) { return angle - turn * std::floor(angle / turn + 0.5); }

void WindowCutter::start_run() {
  run_began_.reset();
  first_.reset();
  last_.reset();
  course_from_.reset();
}

bool WindowCutter::push(const NumberedRun& run, const MeasuredPose& pose, const InputBuffer& commands,
                        const InputBuffer& wheels) {
  Seen seen{.t = pose.t, .x = pose.x, .y = pose.y, .yaw = pose.yaw, .frame = pose.frame};
  run_began_ = run_began_.value_or(seen.t);
  const bool begins = !last_ || last_->frame != seen.frame;
  if (begins) {
    course_from_.reset();
  }
  if (pose.position) {
    seen.yaw = course(seen, wheels.empty() || later(wheels.first(), seen.t) ? commands : wheels);
  }
  if (begins) {
    frame_began_ = seen.t;
    slot_ = turn_ = turn_degrees_ = ahead_ = left_ = 0.0;
    first_ = last_ = seen;
    return true;
  }
  const double turned = within_half_turn(seen.yaw - present(last_).yaw, kWholeTurn);
  add_way(seen, turned);
  turn_ += turned;
  turn_degrees_ += within_half_turn(seen.yaw - present(last_).yaw, 360.0);
  last_ = seen;
  const double slot = std::floor((seen.t - frame_began_ + kSameStamp) / kLength);
  if (slot == slot_) {
    return false;
  }
  close(run, seen, commands, wheels);
  slot_ = slot;
  turn_ = turn_degrees_ = ahead_ = left_ = 0.0;
  first_ = seen;
  return true;
}

/// The arc from the last pose, along the heading amid it.
void WindowCutter::add_way(const Seen& pose, double turned) {
  const Seen& before = present(last_);
  const double half = turned / 2.0;
  const double arc_per_chord = half == 0.0 ? 1.0 : half / std::sin(half);
  const double dx = arc_per_chord * (pose.x - before.x);
  const double dy = arc_per_chord * (pose.y - before.y);
  const double c = std::cos(before.yaw + half);
  const double s = std::sin(before.yaw + half);
  ahead_ += c * dx + s * dy;
  left_ += c * dy - s * dx;
}

void WindowCutter::close(const NumberedRun& run, const Seen& last, const InputBuffer& commands,
                         const InputBuffer& wheels) {
  const Seen& first = present(first_);
  const double duration = last.t - first.t;
  const HeldMotion commanded = commands.held_motion(first.t, last.t);
  const HeldMotion rolled = wheels.held_motion(first.t, last.t);
  const bool known = std::max(commanded.known, rolled.known) > kInputsKnown * duration + kSameStamp;
  if (duration >= kLongestWindow - kSameStamp || !known) {
    return;
  }
  windows_.push_back({.run = run.number,
                      .start = run.origin + first.t,
                      .since = first.t - present(run_began_),
                      .duration = duration,
                      .distance = std::hypot(last.x - first.x, last.y - first.y),
                      .course = std::atan2(last.y - first.y, last.x - first.x),
                      .turn = turn_,
                      .turn_degrees = turn_degrees_,
                      .start_yaw = first.yaw,
                      .ahead = ahead_,
                      .left = left_,
                      .commands = commanded,
                      .wheels = rolled});
  keep_recent(windows_.back());
  if (windows_.size() > kMostWindows) {
    windows_.pop_front();
  }
}

/// However long the robot stands between: a parked robot shows nothing, and forgets nothing.
void WindowCutter::keep_recent(const MotionWindow& window) {
  if (std::max(motion_of(window.commands), motion_of(window.wheels)) <= kDriven) {
    return;
  }
  ++driven_;
  recent_.push_back(window);
  double seconds = 0.0;
  for (const MotionWindow& each : recent_) {
    seconds += each.duration;
  }
  while (seconds - recent_.front().duration >= kRecentDriving) {
    seconds -= recent_.front().duration;
    recent_.pop_front();
  }
}

/// Where the path heads at a position, as far as it has come.
double WindowCutter::course(const Seen& position, const InputBuffer& inputs) {
  if (!course_from_) {
    course_from_ = position;
  }
  const double dx = position.x - course_from_->x;
  const double dy = position.y - course_from_->y;
  if (std::hypot(dx, dy) >= kChord) {
    const bool backward = inputs.held_at(position.t).value_or(BodyTwist{}).v < 0.0;
    course_ = backward ? std::atan2(-dy, -dx) : std::atan2(dy, dx);
    course_from_ = position;
  }
  return course_;
}

}  // namespace slipwise
