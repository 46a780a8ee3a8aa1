// SPDX-License-Identifier: Apache-2.0
// Segments between poses that are as far apart in time as asked for.
#include "slipwise/online/segment_cutter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "slipwise/lie/angle.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

constexpr std::size_t kRecentIntervals = 64;  // intervals between poses that tell the median one
SLIPWISE_TUNING(kLeastFraction, 0.25);        // of the length asked for; a frame shorter than this is no segment
SLIPWISE_TUNING(kLeastOfPositions, 0.5);      // of it; so long is a segment between positions at least,
SLIPWISE_TUNING(kTurnKnown, 0.01);            // [rad] where they tell its turn so well, which is little beside its slip
SLIPWISE_TUNING(kStillPart, 0.1);     // of the run's fastest so far; what is slower stands, if it is slow at all
SLIPWISE_TUNING(kStillAtMost, 2e-3);  // [m/s, rad/s] and slower, every robot stands
SLIPWISE_TUNING(kToAndFro, 0.5);      // of a way or turn; what gets less far is noise of wheels that stand
SLIPWISE_TUNING(kLasting, 0.1);       // [m] by so much positions are off for seconds, however little they scatter

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  if (values.size() % 2 == 1) {
    return *middle;
  }
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double speed_of(const BodyTwist& fastest) { return std::max(fastest.v, fastest.omega); }

/// Whether inputs do no more than noise: they are slow, beside what this run drove so far or by going to and fro.
bool stands(const InputBuffer& inputs, double from, double to, double still_speed) {
  const double fastest = speed_of(inputs.fastest(from, to));
  if (fastest > still_speed || fastest <= std::max(kStillAtMost, kStillPart * speed_of(inputs.fastest_until(to)))) {
    return fastest <= still_speed;
  }
  const HeldMotion net = inputs.held_motion(from, to);
  const InputBuffer::Driven all = inputs.driven(from, to);
  return std::hypot(net.forward, net.sideways) <= kToAndFro * all.distance &&
         std::abs(net.rotation) <= kToAndFro * all.angle;
}

}  // namespace

void PoseInterval::add(double seconds) {
  recent_.push_back(seconds);
  if (recent_.size() > kRecentIntervals) {
    recent_.pop_front();
  }
  ++count_;
  if (count_ < kRecentIntervals || count_ % kRecentIntervals == 0) {
    median_ = median_of({recent_.begin(), recent_.end()});
  }
}

std::optional<TimedPose> PoseTimer::push(const MeasuredPose& pose, double late_factor) {
  TimedPose timed{.pose = pose, .interval = 0.0, .gap = 0.0};
  bool late = false;
  if (last_ && last_->frame == pose.frame) {
    const double before = interval_.median();
    const double interval = pose.t - last_->t;
    late = before > 0.0 && later(interval, late_factor * before);
    interval_.add(interval);
    timed.pose.yaw = last_->yaw + wrap_angle(pose.yaw - last_->yaw);
    gap_ = std::max(gap_, interval);
  } else {
    gap_ = 0.0;
  }
  last_ = timed.pose;
  timed.interval = interval_.median();
  timed.gap = gap_;
  if (late) {
    return std::nullopt;
  }
  gap_ = 0.0;
  return timed;
}

Pose2 SegmentCut::measured() const {
  const double dx = second.x - first.x;
  const double dy = second.y - first.y;
  const double c = std::cos(first.yaw);
  const double s = std::sin(first.yaw);
  return {c * dx + s * dy, c * dy - s * dx, second.yaw - first.yaw};
}

SegmentCutter::SegmentCutter(double length, SegmentRules rules, bool whole_frames, std::optional<double> stride)
    : length_(length), rules_(rules), whole_frames_(whole_frames), stride_(stride) {}

std::vector<SegmentCut> SegmentCutter::push(const TimedPose& pose, const InputBuffer& inputs) {
  std::vector<SegmentCut> out;
  if (!poses_.empty() && poses_.back().pose.frame != pose.pose.frame) {
    end_frame(inputs, out);
  }
  if (unknown_since_) {
    const auto again = inputs.first_after(*unknown_since_);
    if (!again || later(*again, pose.pose.t)) {
      poses_.assign(1, pose);  // a frame goes on, yet no segment can start here
      return out;
    }
    poses_.clear();
    unknown_since_.reset();
  }
  poses_.push_back(pose);
  const double length = wanted();
  cut(tells_enough(length, inputs) ? pose.pose.t - poses_.front().pose.t : length, false, inputs, out);
  return out;
}

std::vector<SegmentCut> SegmentCutter::finish(const InputBuffer& inputs) {
  std::vector<SegmentCut> out;
  end_frame(inputs, out);
  return out;
}

void SegmentCutter::end_frame(const InputBuffer& inputs, std::vector<SegmentCut>& out) {
  double length = wanted();
  if (!poses_.empty() && !any_ && whole_frames_) {
    const double whole = poses_.back().pose.t - poses_.front().pose.t;
    length = !later(kLeastFraction * length, whole) && whole < length ? whole : length;
  }
  if (!unknown_since_) {
    cut(length, true, inputs, out);
  }
  poses_.clear();
  any_ = false;
  unknown_since_.reset();
}

/// Where `last`, no pose follows; otherwise a segment is cut once there is a pose that is late enough to end it.
void SegmentCutter::cut(double length, bool last, const InputBuffer& inputs, std::vector<SegmentCut>& out) {
  while (poses_.size() > 1 && !unknown_since_ &&
         (last || !later(poses_.front().pose.t + length, poses_.back().pose.t))) {
    const TimedPose& start = poses_.front();
    const double interval = start.interval > 0.0 ? start.interval : poses_[1].interval;
    const double tolerance = std::max(0.5 * interval, rules_.length_tolerance * length);
    const auto end = nearest(start.pose.t + length, tolerance, last);
    std::size_t next = 1;
    if (end && *end > 0) {
      const auto wrong = problem(*end, inputs);
      out.push_back({.first = start.pose,
                     .second = poses_[*end].pose,
                     .rejected = wrong,
                     .positions = wrong ? std::vector<MeasuredPose>{} : positions_until(*end)});
      next = next_start(*end, wrong, inputs);
    }
    any_ = true;
    poses_.erase(poses_.begin(), poses_.begin() + static_cast<std::ptrdiff_t>(std::min(next, poses_.size())));
  }
}

double SegmentCutter::wanted() const {
  return !poses_.empty() && poses_.front().pose.position ? std::max(length_, rules_.of_positions) : length_;
}

/// Whether positions so far tell the turn of a straight way of that length as well as they need to. They tell its
/// curvature by a parabola's last coefficient, whose variance is 180 of theirs, over their number and the length's
/// fourth power.
bool SegmentCutter::tells_enough(double length, const InputBuffer& inputs) const {
  const TimedPose& start = poses_.front();
  const double end = poses_.back().pose.t;
  if (!start.pose.position || rules_.of_positions == 0.0 || later(start.pose.t + kLeastOfPositions * length, end)) {
    return false;
  }
  const double way = inputs.driven(start.pose.t, end).distance;
  return std::sqrt(720.0 / static_cast<double>(poses_.size())) * std::max(noise_, kLasting) <= kTurnKnown * way;
}

/// Neighbouring segments share a moment and no position.
std::vector<MeasuredPose> SegmentCutter::positions_until(std::size_t end) const {
  std::vector<MeasuredPose> found;
  for (std::size_t i = 0; i < end && poses_.front().pose.position; ++i) {
    found.push_back(poses_[i].pose);
  }
  return found;
}

std::size_t SegmentCutter::first_from(double t) const {
  const auto stamp = [](const TimedPose& timed) { return timed.pose.t; };
  return static_cast<std::size_t>(std::ranges::lower_bound(poses_, t - kSameStamp, {}, stamp) - poses_.begin());
}

/// The pose nearest to the time wanted, of two that are as near the earlier, where one is within the tolerance.
std::optional<std::size_t> SegmentCutter::nearest(double wanted, double tolerance, bool last) const {
  const auto stamp = [](const TimedPose& timed) { return timed.pose.t; };
  const std::size_t right = first_from(wanted);
  if (right == poses_.size() && !last) {
    return std::nullopt;
  }
  std::optional<std::size_t> best;
  for (const std::size_t i : {right - 1, right}) {
    const bool there = i < poses_.size();  // false for what wrapped round below 0
    if (there && (!best || later(std::abs(stamp(poses_[*best]) - wanted), std::abs(stamp(poses_[i]) - wanted)))) {
      best = i;
    }
  }
  return best && !later(std::abs(stamp(poses_[*best]) - wanted), tolerance) ? best : std::nullopt;
}

/// Why the first pose and this one make no segment, if they do not.
std::optional<Reason> SegmentCutter::problem(std::size_t end, const InputBuffer& inputs) const {
  const double from = poses_.front().pose.t;
  const double to = poses_[end].pose.t;
  if (inputs.empty() || inputs.unknown_since(from, to)) {
    return Reason::UnknownInput;
  }
  const BodyTwist fastest = inputs.fastest(from, to);
  if (stands(inputs, from, to, rules_.still_speed)) {
    return Reason::StandingStill;
  }
  double longest = 0.0;
  for (std::size_t i = 1; i <= end; ++i) {
    longest = std::max(longest, poses_[i].gap);
  }
  return fastest.omega * longest > std::numbers::pi ? std::optional(Reason::AmbiguousHeading) : std::nullopt;
}

/// How many poses come before the next segment's start.
std::size_t SegmentCutter::next_start(std::size_t end, std::optional<Reason> problem, const InputBuffer& inputs) {
  if (problem == Reason::UnknownInput) {
    const double since =
        inputs.empty()
            ? poses_.front().pose.t
            : inputs.unknown_since(poses_.front().pose.t, poses_[end].pose.t).value_or(poses_.front().pose.t);
    const auto again = inputs.first_after(since);
    if (!again || later(*again, poses_.back().pose.t)) {
      unknown_since_ = since;
      return poses_.size() - 1;  // the last is kept: its frame goes on
    }
    return std::max<std::size_t>(1, first_from(*again));
  }
  if (problem == Reason::AmbiguousHeading) {
    return 1;
  }
  return stride_ ? std::max<std::size_t>(1, first_from(poses_.front().pose.t + *stride_)) : end;
}

}  // namespace slipwise
