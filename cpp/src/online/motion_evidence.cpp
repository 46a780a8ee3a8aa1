// SPDX-License-Identifier: Apache-2.0
// Windows, pairs and sums of what a stream uses.
#include "slipwise/online/motion_evidence.hpp"

#include <algorithm>
#include <cmath>

#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/sample_gate.hpp"

namespace slipwise {
namespace {

constexpr double kSecond = 1.0;               // [s] over which turns are compared
constexpr double kTurning = 0.1;              // [rad/s] of the inputs
constexpr double kKnownPart = 0.9;            // of a second, inputs must be known
constexpr double kLongestGap = 4.0;           // [s] between yaw rates; nothing is compared across a longer one
constexpr std::size_t kMostYawRates = 20000;  // that wait where neither poses nor inputs come
constexpr std::size_t kMostRuns = 100;
constexpr std::size_t kRecentSeconds = 120;  // of turning

GateCounts sum(const GateCounts& a, const GateCounts& b) {
  return {.accepted = a.accepted + b.accepted, .outliers = a.outliers + b.outliers, .jumps = a.jumps + b.jumps};
}

GateCounts difference(const GateCounts& a, const GateCounts& b) {
  return {.accepted = a.accepted - b.accepted, .outliers = a.outliers - b.outliers, .jumps = a.jumps - b.jumps};
}

/// Adds the seconds of one run to the sums of it.
void add(const GyroTurns& seconds, std::deque<GyroTurns>& runs) {
  if (runs.empty() || runs.back().run != seconds.run) {
    runs.push_back({.run = seconds.run});
  }
  GyroTurns& turns = runs.back();
  turns.count += seconds.count;
  turns.product += seconds.product;
  turns.square += seconds.square;
}

}  // namespace

void MotionEvidence::start_run() {
  run_.number += run_begins_ ? 0 : 1;
  run_begins_ = true;
  measured_.start_run();
  accepted_.start_run();
  probes_.start_run();
  yaw_rates_.clear();
  second_.reset();
}

void MotionEvidence::end_run(const InputBuffer& wheels) { probes_.end_run(wheels); }

void MotionEvidence::see_stamp(double t) { run_begins_ = run_begins_ && !(std::abs(run_.origin + t) <= kLatestStamp); }

void MotionEvidence::see_measured(const MeasuredPose& pose, const InputBuffer& commands, const InputBuffer& wheels) {
  const std::size_t before = measured_.driven();
  if (!measured_.push(run_, pose, commands, wheels)) {
    return;
  }
  if (measured_.driven() > before) {
    gated_.push_back(difference(counts_, counts_before_));
  }
  while (gated_.size() > measured_.recent().size()) {
    gated_.pop_front();
  }
  counts_before_ = counts_;
}

void MotionEvidence::see_gated(const GatedPoses& gated, const InputBuffer& commands, const InputBuffer& wheels) {
  for (const MeasuredPose& pose : gated.accepted) {
    accepted_.push(run_, pose, commands, wheels);
    probes_.push(pose, wheels);
  }
  counts_.accepted += gated.accepted.size();
  counts_.outliers += gated.outliers.size();
  counts_.jumps += gated.jumps.size();
}

void MotionEvidence::compare_gyro(double t, const InputBuffer& commands, const InputBuffer& wheels) {
  while (yaw_rates_.size() > 1) {
    second_ = second_.value_or(yaw_rates_.front().t);
    const double end = *second_ + kSecond;
    if (later(yaw_rates_[1].t, yaw_rates_[0].t + kLongestGap)) {
      yaw_rates_.pop_front();
      second_.reset();
    } else if (yaw_rates_[1].t <= *second_) {
      yaw_rates_.pop_front();
    } else if (end > t || !later(yaw_rates_.back().t, end)) {
      break;
    } else {
      compare_second(wheels.empty() || later(wheels.first(), *second_) ? commands : wheels, *second_);
      second_ = end;
    }
  }
  while (yaw_rates_.size() > kMostYawRates) {
    yaw_rates_.pop_front();
    second_.reset();
  }
}

void MotionEvidence::compare_second(const InputBuffer& inputs, double start) {
  const HeldMotion held = inputs.held_motion(start, start + kSecond);
  if (std::abs(held.rotation) <= kTurning * kSecond || held.known <= kKnownPart * kSecond + kSameStamp) {
    return;
  }
  const double turned = turn_until(start + kSecond) - turn_until(start);
  last_seconds_.push_back(
      {.run = run_.number, .count = 1, .product = held.rotation * turned, .square = held.rotation * held.rotation});
  ++gyro_seconds_;
  add(last_seconds_.back(), gyro_turns_);
  if (gyro_turns_.size() > kMostRuns) {
    gyro_turns_.pop_front();
  }
  if (last_seconds_.size() > kRecentSeconds) {
    last_seconds_.pop_front();
  }
}

std::optional<RecentEvidence> MotionEvidence::recent() const {
  if (measured_.recent().size() == measured_.driven() && last_seconds_.size() == gyro_seconds_) {
    return std::nullopt;
  }
  RecentEvidence found{.measured_windows = measured_.recent(),
                       .windows = accepted_.recent(),
                       .probes = probes_.recent(),
                       .gyro_turns = {},
                       .counts = {}};
  for (const GyroTurns& second : last_seconds_) {
    add(second, found.gyro_turns);
  }
  for (const GateCounts& each : gated_) {
    found.counts = sum(found.counts, each);
  }
  return found;
}

/// The gyro's turn from its first sample to `t`, rates between samples being on a line [rad].
double MotionEvidence::turn_until(double t) const {
  double turn = 0.0;
  for (std::size_t i = 1; i < yaw_rates_.size() && yaw_rates_[i - 1].t < t; ++i) {
    const TimedNumber& before = yaw_rates_[i - 1];
    const TimedNumber& after = yaw_rates_[i];
    const double part = std::min(1.0, (t - before.t) / (after.t - before.t));
    turn += 0.5 * part * (after.t - before.t) * (before.value + after.value);
  }
  return turn;
}

}  // namespace slipwise
