// SPDX-License-Identifier: Apache-2.0
// The way of a few seconds, by the inputs and as it was measured.
#include "slipwise/online/course_finder.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "slipwise/lie/angle.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/linear/tuning.hpp"
#include "slipwise/sensor/sensor_motion.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kOldest, 3.0);          // [s] what was driven before tells little of where the robot heads
SLIPWISE_TUNING(kShortest, 0.25);       // [m] a way that spreads like a straight line so long has a course
SLIPWISE_TUNING(kCourseTime, 0.5);      // [s] at the fastest commanded speed so far make a way that is long enough,
SLIPWISE_TUNING(kLongestWay, 0.5);      // [m] which is no longer,
SLIPWISE_TUNING(kLengthOfNoise, 10.0);  // unless it would not be this many of the standard deviations that are stated
constexpr double kWaysApart = 3.0;      // a way and the same by the inputs may differ by this factor
constexpr double kFewest = 3.0;         // positions
constexpr double kOfLine = 12.0;        // a line is so many times longer squared than it spreads

/// Of the latest positions, as they were measured and as the inputs lead to them, both from the last one.
struct Together {
  double count = 0.0;
  Eigen::Vector2d measured = Eigen::Vector2d::Zero();
  Eigen::Vector2d reckoned = Eigen::Vector2d::Zero();
  double along = 0.0;
  double across = 0.0;
  std::array<double, 2> squares{};

  void add(const Eigen::Vector2d& to, const Eigen::Vector2d& from) {
    count += 1.0;
    measured += to;
    reckoned += from;
    along += from.dot(to);
    across += from.x() * to.y() - from.y() * to.x();
    squares[0] += from.squaredNorm();
    squares[1] += to.squaredNorm();
  }
  /// The same about their means.
  Together centred() const {
    Together found = *this;
    found.along -= reckoned.dot(measured) / count;
    found.across -= (reckoned.x() * measured.y() - reckoned.y() * measured.x()) / count;
    found.squares[0] -= reckoned.squaredNorm() / count;
    found.squares[1] -= measured.squaredNorm() / count;
    return found;
  }
  /// Whether both spread like a straight line so long [m].
  bool spread(double length) const { return std::min(squares[0], squares[1]) >= count * length * length / kOfLine; }
};

double length_for(const MeasuredPose& position, const InputBuffer& inputs) {
  const double driven = kCourseTime * inputs.fastest_until(position.t).v;
  return std::max(std::clamp(driven, double{kShortest}, double{kLongestWay}), kLengthOfNoise * position.std.xy);
}

}  // namespace

std::optional<double> CourseFinder::push(const MeasuredPose& position, const InputBuffer& inputs) {
  if (frame_ != position.frame) {
    passed_.clear();
    last_yaw_.reset();
    frame_ = position.frame;
  }
  const bool known = !inputs.empty() && !passed_.empty() && !inputs.unknown_since(passed_.back().t, position.t);
  const Pose2 robot = known ? compose(passed_.back().reckoned, inputs.reckoned(passed_.back().t, position.t)) : Pose2{};
  if (!known) {
    passed_.clear();
  }
  while (!passed_.empty() && later(position.t - kOldest, passed_.front().t)) {
    passed_.pop_front();
  }
  passed_.push_back({.t = position.t, .measured = {position.x, position.y}, .reckoned = robot});
  const Eigen::Vector2d antenna = sensor_motion(robot, sensor_).vector().head<2>();
  const double length = known ? length_for(position, inputs) : double{kLongestWay};
  Together sum;
  Together found;
  for (auto each = passed_.rbegin(); each != passed_.rend() && (sum.count < kFewest || !found.spread(length)); ++each) {
    sum.add(each->measured - passed_.back().measured,
            sensor_motion(each->reckoned, sensor_).vector().head<2>() - antenna);
    found = sum.centred();
  }
  const double apart = std::sqrt(found.squares[0] / found.squares[1]);
  if (!found.spread(kShortest) || !(apart <= kWaysApart) || !(apart * kWaysApart >= 1.0)) {
    return std::nullopt;
  }
  const double yaw = std::atan2(found.across, found.along) + robot.theta - sensor_.theta;
  last_yaw_ = last_yaw_ ? *last_yaw_ + wrap_angle(yaw - *last_yaw_) : wrap_angle(yaw);
  return last_yaw_;
}

}  // namespace slipwise
