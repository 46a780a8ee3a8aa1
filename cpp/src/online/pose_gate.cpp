// SPDX-License-Identifier: Apache-2.0
// Steps between poses beside what the inputs allow.
#include "slipwise/online/pose_gate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ranges>
#include <tuple>
#include <utility>

#include "slipwise/lie/angle.hpp"

namespace slipwise {
namespace {

constexpr double kLate = 1.0;      // [s] poses may be late or early by this much,
constexpr double kBusy = 0.5;      // [s] or by this much more than the time since the last: a localiser that stalls
constexpr double kSlip = 1.1;      // a robot may move this much further than its inputs say
constexpr double kUnknown = 1.5;   // and where there are no inputs, this much faster than it ever did
constexpr double kDistance = 0.5;  // [m] on top of that, before it is called a jump
constexpr double kAngle = 0.8;     // [rad]
constexpr double kWholeTurns = 4.0 * std::numbers::pi;  // [rad] a heading is wrapped by one turn at most
constexpr double kNoise = 8.0;                          // standard deviations of the poses' own noise
constexpr std::size_t kLongestOutlier = 3;              // poses
constexpr double kBendOfNoise = 1.652;  // median of |second difference| of noise of 1: 0.6745 sqrt(1 + 4 + 1)
constexpr double kFirstNoise = 0.5;     // [m] the poses' noise may be, while too few tell it
constexpr std::size_t kFewBends = 8;
constexpr double kLeastBend = 1e-3;  // [m] the finest that is distinguished

double distance(const MeasuredPose& from, const MeasuredPose& to) { return std::hypot(to.x - from.x, to.y - from.y); }
double angle(const MeasuredPose& from, const MeasuredPose& to) { return std::abs(wrap_angle(to.yaw - from.yaw)); }

}  // namespace

/// Whether `to` is out of reach. Poses may be late, and early by what the robot goes on as it does.
bool PoseGate::jumps(const MeasuredPose& from, const MeasuredPose& to, const InputBuffer& inputs) const {
  if (inputs.empty()) {
    return false;
  }
  const double late = std::max(kLate, kBusy + to.t - from.t);
  const InputBuffer::Driven between = inputs.driven(from.t, to.t);
  const InputBuffer::Driven widely = inputs.driven(from.t - late, to.t);
  const BodyTwist now = inputs.known_at(to.t).value_or(BodyTwist{});
  const BodyTwist top = inputs.fastest_until(to.t);
  const double unknown = kUnknown * std::max(to.t - from.t - between.known, 0.0);
  const double path = kSlip * (widely.distance + std::hypot(now.v, now.vy) * late) + top.v * unknown;
  const double turn = kSlip * (widely.angle + std::abs(now.omega) * late) + top.omega * unknown;
  const double bend = std::max(bends_[0].quantile(0.5, 0.0), bends_[1].quantile(0.5, 0.0));
  const double noise = bend_count_ < kFewBends ? kFirstNoise : bend / kBendOfNoise;
  const bool far = distance(from, to) > path + std::max(kDistance, kNoise * noise);
  const bool turned = angle(from, to) > turn + kAngle || std::abs(to.yaw - from.yaw) > turn + kWholeTurns;
  return far || turned;
}

/// Whether it lies far nearer to where the step began than where the step ended.
bool PoseGate::returns(const MeasuredPose& to) const {
  const MeasuredPose& from = accepted_.back();
  const MeasuredPose& out = waiting_.front();
  return distance(from, to) < 0.5 * std::max(distance(from, out), kDistance) &&
         angle(from, to) < 0.5 * std::max(angle(from, out), kAngle);
}

void PoseGate::learn_noise(const MeasuredPose& pose) {
  if (accepted_.size() == 3) {
    accepted_.erase(accepted_.begin());
  }
  accepted_.push_back(pose);
  if (accepted_.size() == 3) {
    const auto& [a, b, c] = std::tie(accepted_[0], accepted_[1], accepted_[2]);
    bends_[0].add(std::max(std::abs(c.x - 2.0 * b.x + a.x), kLeastBend), 1.0);
    bends_[1].add(std::max(std::abs(c.y - 2.0 * b.y + a.y), kLeastBend), 1.0);
    ++bend_count_;
  }
}

void PoseGate::accept(const MeasuredPose& pose, GatedPoses& out) {
  learn_noise(pose);
  out.accepted.push_back(pose);
  out.accepted.back().frame = frame_;
}

/// What waits does not come back: a frame of its own begins with it.
void PoseGate::give_up(const InputBuffer& inputs, GatedPoses& out) {
  if (waiting_.empty()) {
    return;
  }
  const std::vector<MeasuredPose> waiting = std::exchange(waiting_, {});
  begin_frame(waiting.front(), out);
  out.jumps.push_back(waiting.front());
  for (const MeasuredPose& pose : waiting | std::views::drop(1)) {
    take(pose, inputs, out);
  }
}

void PoseGate::begin_frame(const MeasuredPose& pose, GatedPoses& out) {
  ++frame_;
  accepted_.clear();
  accept(pose, out);
}

/// A pose of the same frame as it was given.
void PoseGate::take(const MeasuredPose& pose, const InputBuffer& inputs, GatedPoses& out) {
  const bool near = !jumps(accepted_.back(), pose, inputs);
  if (near && waiting_.empty()) {
    accept(pose, out);
  } else if (near && returns(pose)) {
    out.outliers.insert(out.outliers.end(), waiting_.begin(), waiting_.end());
    waiting_.clear();
    accept(pose, out);
  } else {
    waiting_.push_back(pose);
    if (waiting_.size() > kLongestOutlier) {
      give_up(inputs, out);
    }
  }
}

GatedPoses PoseGate::push(const MeasuredPose& pose, const InputBuffer& inputs) {
  GatedPoses out;
  if (given_ == pose.frame) {
    take(pose, inputs, out);
    return out;
  }
  give_up(inputs, out);
  given_ = pose.frame;
  begin_frame(pose, out);
  return out;
}

GatedPoses PoseGate::finish(const InputBuffer& inputs) {
  GatedPoses out;
  while (!waiting_.empty()) {
    give_up(inputs, out);
  }
  return out;
}

void PoseGate::restart() {
  accepted_.clear();
  waiting_.clear();
  given_.reset();
}

}  // namespace slipwise
