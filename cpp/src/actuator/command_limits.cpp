// SPDX-License-Identifier: Apache-2.0
// Walking over held commands with two lanes that ramp.
#include "slipwise/actuator/command_limits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "slipwise/actuator/first_order_lag.hpp"

namespace slipwise {
namespace {

constexpr double kNoTime = 1e-6;        // [s]; stamps that count from 1970 are no finer
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

  /// The mean over a piece, of which `taken` seconds pass.
  double mean_over(double piece, double taken) {
    if (taken == piece) {
      return follow(piece) / piece;
    }
    LaneRamp whole = *this;
    follow(taken);
    return whole.follow(piece) / piece;
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

  /// A twist that goes on as it was needs no sample.
  void push(double time, const BodyTwist& twist) {
    if (!t.empty() && v.back() == twist.v && vy.back() == twist.vy && omega.back() == twist.omega) {
      return;
    }
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
  if (std::isnan(limits.dead_band) || limits.dead_band < 0.0 || std::isinf(limits.dead_band)) {
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
  check(limits.speed, "speed");
  check(limits.yaw_rate, "yaw rate");
  check(limits.side, "side");
  const auto positive = [](const char* name, double value) {
    if (std::isnan(value) || value <= 0.0 || std::isinf(value)) {
      throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) + "; give more than zero");
    }
  };
  positive("the track between the sides", limits.track);
  positive("the gain of the speed", limits.gain_v);
  positive("the gain of the yaw rate", limits.gain_omega);
  positive("a ramp's longest piece", longest_piece);
}

struct LanePair {
  double first, second;
};

/// Walks over held commands with two lanes; `to` and `from` turn a twist into what is asked of the lanes, and back.
template <typename To, typename From>
InputTrack ramped(const InputTrack& commands, std::array<LaneRamp, 2> lanes, double longest_piece, To to, From from) {
  auto& [first, second] = lanes;
  Columns out(commands.size());
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const BodyTwist command = commands.sample(i);
    const LanePair asked = to(command);
    first.aim(asked.first);
    second.aim(asked.second);
    const double next = i + 1 < commands.size() ? commands.time(i + 1) : std::numeric_limits<double>::infinity();
    double now = commands.time(i);
    const double ramp = std::min(std::max(first.seconds_left(), second.seconds_left()), kLongestRamp);
    if (ramp > kNoTime) {
      const int pieces = lag_parts(ramp, std::max(longest_piece, ramp / kMostPieces));
      const double piece = ramp / pieces;
      for (int k = 0; k < pieces && next - now > kNoTime; ++k) {
        const double taken = std::min(piece, next - now);
        const LanePair means{first.mean_over(piece, taken), second.mean_over(piece, taken)};
        out.push(now, from(means, command.vy));
        now += taken;
      }
    }
    if (next - now > kNoTime) {
      out.push(now, from({first.target(), second.target()}, command.vy));
    }
  }
  return {out.t, out.v, out.vy, out.omega};
}

}  // namespace

bool limits_sides(const CommandLimits& limits) { return limits.side != LaneLimits{}; }

bool unlimited(const CommandLimits& limits) {
  return limits.speed == LaneLimits{} && limits.yaw_rate == LaneLimits{} && !limits_sides(limits);
}

CommandLimits channel_limits(const CommandLimits& limits) {
  return {.speed = limits.speed, .yaw_rate = limits.yaw_rate};
}

SideSpeeds side_speeds(const CommandLimits& limits, const BodyTwist& twist) {
  const double v = limits.gain_v * twist.v;
  const double half = 0.5 * limits.gain_omega * twist.omega * limits.track;
  return {v - half, v + half};
}

InputTrack limited_track(const InputTrack& commands, const CommandLimits& limits, double longest_piece) {
  check(limits, longest_piece);
  if (unlimited(limits)) {
    return commands;
  }
  const auto as_channels = [](const BodyTwist& twist) { return LanePair{twist.v, twist.omega}; };
  const auto from_channels = [](const LanePair& lanes, double vy) { return BodyTwist{lanes.first, vy, lanes.second}; };
  const auto as_sides = [&](const BodyTwist& twist) {
    const SideSpeeds sides = side_speeds(limits, twist);
    return LanePair{sides.left, sides.right};
  };
  const auto from_sides = [&](const LanePair& lanes, double vy) {
    return BodyTwist{0.5 * (lanes.first + lanes.second), vy, (lanes.second - lanes.first) / limits.track};
  };
  const std::array<LaneRamp, 2> channels{LaneRamp(limits.speed), LaneRamp(limits.yaw_rate)};
  const std::array<LaneRamp, 2> sides{LaneRamp(limits.side), LaneRamp(limits.side)};
  if (!limits_sides(limits)) {
    return ramped(commands, channels, longest_piece, as_channels, from_channels);
  }
  if (unlimited(channel_limits(limits))) {
    return ramped(commands, sides, longest_piece, as_sides, from_sides);
  }
  const InputTrack limited = ramped(commands, channels, longest_piece, as_channels, from_channels);
  return ramped(limited, sides, longest_piece, as_sides, from_sides);
}

}  // namespace slipwise
