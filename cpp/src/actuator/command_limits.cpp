// SPDX-License-Identifier: Apache-2.0
// Walking over held commands with two lanes that ramp.
#include "slipwise/actuator/command_limits.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "slipwise/actuator/first_order_lag.hpp"

namespace slipwise {
namespace {

constexpr double kNoTime = 1e-6;  // [s]; stamps that count from 1970 are no finer
constexpr double kMostPieces = 2000.0;  // of one ramp, however slow
constexpr double kLongestRamp = 1e6;    // [s]; nobody waits longer

/// The set speed of one lane, which follows its target as fast as it may.
class LaneRamp {
 public:
  explicit LaneRamp(const LaneLimits& limits) : limits_(limits) {}

  void aim(double command) {
    target_ = std::abs(command) < limits_.dead_band ? 0.0 : std::clamp(command, -limits_.top, limits_.top);
    follow(0.0);
  }

  double target() const { return target_; }

  double seconds_left() const {
    const bool turns = state_ * target_ < 0.0;
    const double gap = std::abs(target_ - state_);
    return turns ? std::abs(state_) / limits_.braking + std::abs(target_) / limits_.acceleration
                 : gap / rate_towards(target_);
  }

  /// Goes on for `seconds`; returns the integral.
  double follow(double seconds) {
    double integral = 0.0;
    for (int phase = 0; phase < 2 && state_ != target_; ++phase) {
      const double goal = state_ * target_ < 0.0 ? 0.0 : target_;
      const double rate = rate_towards(goal);
      const double needed = std::abs(goal - state_) / rate;
      const double next = needed <= seconds ? goal : state_ + std::copysign(rate * seconds, goal - state_);
      const double taken = std::min(needed, seconds);
      integral += 0.5 * (state_ + next) * taken;
      state_ = next;
      seconds -= taken;
    }
    return integral + state_ * seconds;
  }

 private:
  double rate_towards(double goal) const {
    return std::abs(goal) < std::abs(state_) ? limits_.braking : limits_.acceleration;
  }

  LaneLimits limits_;
  double state_ = 0.0;
  double target_ = 0.0;
};

/// Samples of the limited track as they come.
struct Columns {
  std::vector<double> t, v, vy, omega;

  explicit Columns(std::size_t size) {
    for (auto* column : {&t, &v, &vy, &omega}) {
      column->reserve(size);
    }
  }

  void push(double time, const BodyTwist& twist) {
    t.push_back(time);
    v.push_back(twist.v);
    vy.push_back(twist.vy);
    omega.push_back(twist.omega);
  }
};

void check(const LaneLimits& limits, const char* lane) {
  const auto refuse = [&](const char* name, double value, const char* wanted) {
    throw std::invalid_argument("the " + std::string(lane) + " lane's " + name + " is " + std::to_string(value) +
                                "; give " + wanted + ", or leave it out");
  };
  if (!(limits.dead_band >= 0.0 && std::isfinite(limits.dead_band))) {
    refuse("dead band", limits.dead_band, "zero or more");
  }
  if (!(limits.top > 0.0)) {
    refuse("top speed", limits.top, "more than zero");
  }
  if (!(limits.acceleration > 0.0)) {
    refuse("acceleration", limits.acceleration, "more than zero");
  }
  if (!(limits.braking > 0.0)) {
    refuse("braking", limits.braking, "more than zero");
  }
}

void check(const CommandLimits& limits, double longest_piece) {
  check(limits.first, "first");
  check(limits.second, "second");
  if (limits.lanes == Lanes::Sides && !(limits.track > 0.0 && std::isfinite(limits.track))) {
    throw std::invalid_argument("the track between the sides is " + std::to_string(limits.track) +
                                " m; give more than zero");
  }
  if (!(longest_piece > 0.0)) {
    throw std::invalid_argument("a ramp's longest piece is " + std::to_string(longest_piece) +
                                " s; give more than zero");
  }
}

}  // namespace

bool unlimited(const CommandLimits& limits) {
  return limits.first == LaneLimits{} && limits.second == LaneLimits{};
}

LanePair to_lanes(const CommandLimits& limits, double v, double omega) {
  if (limits.lanes == Lanes::Channels) {
    return {v, omega};
  }
  const double half = 0.5 * omega * limits.track;
  return {v - half, v + half};
}

BodyTwist from_lanes(const CommandLimits& limits, const LanePair& lanes, double vy) {
  if (limits.lanes == Lanes::Channels) {
    return {lanes.first, vy, lanes.second};
  }
  return {0.5 * (lanes.first + lanes.second), vy, (lanes.second - lanes.first) / limits.track};
}

InputTrack limited_track(const InputTrack& commands, const CommandLimits& limits, double longest_piece) {
  check(limits, longest_piece);
  if (unlimited(limits)) {
    return commands;
  }
  LaneRamp first(limits.first);
  LaneRamp second(limits.second);
  Columns out(commands.size());
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const BodyTwist command = commands.sample(i);
    const LanePair lanes = to_lanes(limits, command.v, command.omega);
    first.aim(lanes.first);
    second.aim(lanes.second);
    const double ramp = std::min(std::max(first.seconds_left(), second.seconds_left()), kLongestRamp);
    const int pieces = lag_parts(ramp, std::max(longest_piece, ramp / kMostPieces));
    const double piece = ramp / pieces;
    const double next = i + 1 < commands.size() ? commands.time(i + 1) : std::numeric_limits<double>::infinity();
    double now = commands.time(i);
    for (int k = 0; k < pieces && piece > kNoTime && next - now > kNoTime; ++k) {
      LaneRamp first_whole = first;
      LaneRamp second_whole = second;
      const double whole_first = first_whole.follow(piece) / piece;
      const double whole_second = second_whole.follow(piece) / piece;
      out.push(now, from_lanes(limits, {whole_first, whole_second}, command.vy));
      const double taken = std::min(piece, next - now);
      first.follow(taken);
      second.follow(taken);
      now += taken;
    }
    if (next - now > kNoTime) {
      out.push(now, from_lanes(limits, {first.target(), second.target()}, command.vy));
    }
  }
  return {out.t, out.v, out.vy, out.omega};
}

}  // namespace slipwise
