// SPDX-License-Identifier: Apache-2.0
// The shortest chord that is long enough, and what the inputs say of it.
#include "slipwise/online/chord_finder.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "slipwise/lie/angle.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kChordTime, 1.0);       // [s] at the fastest commanded speed so far make a chord,
SLIPWISE_TUNING(kShortest, 0.25);       // [m] which is no shorter
SLIPWISE_TUNING(kLongest, 1.0);         // [m] and no longer,
SLIPWISE_TUNING(kLengthOfNoise, 20.0);  // unless it would not be this many of the standard deviations that are stated
SLIPWISE_TUNING(kOldest, 5.0);          // [s] a chord that takes longer tells little of where the robot heads
constexpr double kApart = 3.0;          // a chord and the same by the inputs may differ by this factor

double length_for(const MeasuredPose& position, const InputBuffer& inputs) {
  const double driven = kChordTime * inputs.fastest_until(position.t).v;
  return std::max(std::clamp(driven, double{kShortest}, double{kLongest}), kLengthOfNoise * position.std.xy);
}

}  // namespace

std::optional<MeasuredPose> ChordFinder::push(const MeasuredPose& position, const InputBuffer& inputs) {
  if (!positions_.empty() && positions_.back().frame != position.frame) {
    positions_.clear();
    last_yaw_.reset();
  }
  while (!positions_.empty() && later(position.t - kOldest, positions_.front().t)) {
    positions_.pop_front();
  }
  const double length = length_for(position, inputs);
  const auto far = [&](const MeasuredPose& before) {
    return std::hypot(position.x - before.x, position.y - before.y) >= length;
  };
  MeasuredPose found = position;
  auto& [first, second] = found.headings;
  for (auto from = positions_.rbegin(); from != positions_.rend() && !second; ++from) {
    if (first || far(*from)) {
      (first ? second : first) = along(*from, position, inputs);
      if (!first) {
        break;
      }
    }
  }
  positions_.push_back(position);
  if (!first) {
    return std::nullopt;
  }
  found.yaw = first->yaw;
  last_yaw_ = found.yaw;
  return found;
}

std::optional<ChordHeading> ChordFinder::along(const MeasuredPose& from, const MeasuredPose& to,
                                               const InputBuffer& inputs) const {
  if (inputs.empty() || inputs.unknown_since(from.t, to.t)) {
    return std::nullopt;
  }
  const Eigen::Vector2d measured(to.x - from.x, to.y - from.y);
  const Pose2 robot = inputs.reckoned(from.t, to.t);
  const Eigen::Vector2d antenna(sensor_.x, sensor_.y);
  const Eigen::Vector2d expected = Eigen::Vector2d(robot.x, robot.y) + rotation(robot.theta) * antenna - antenna;
  if (expected.norm() * kApart < measured.norm() || expected.norm() > kApart * measured.norm()) {
    return std::nullopt;
  }
  const double offset = wrap_angle(robot.theta - std::atan2(expected.y(), expected.x()));
  const double yaw = std::atan2(measured.y(), measured.x()) + offset;
  return ChordHeading{.yaw = last_yaw_ ? *last_yaw_ + wrap_angle(yaw - *last_yaw_) : wrap_angle(yaw),
                      .chord = {.from = from.t, .offset = offset}};
}

}  // namespace slipwise
