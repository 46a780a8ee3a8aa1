// SPDX-License-Identifier: Apache-2.0
// Walking over held commands whose drive ramps.
#include "slipwise/actuator/command_limits.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "slipwise/actuator/axis_response.hpp"
#include "slipwise/actuator/command_limiter.hpp"
#include "slipwise/actuator/first_order_lag.hpp"
#include "slipwise/actuator/limit_kinds.hpp"
#include "slipwise/actuator/measured_start.hpp"
#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr int kMostPieces = 2000;     // of one ramp, however slow
constexpr double kLongestRamp = 1e6;  // [s]; no drive takes longer

void check(const AxisLimits& limits, const char* axis) {
  for (const LimitRow& row : kLimits) {
    const double value = limits.*row.value;
    const bool least = AxisLimits{}.*row.value == 0.0;  // what limits nothing is the least of it, or infinite
    if (!(least ? value >= 0.0 && std::isfinite(value) : value > 0.0)) {
      throw std::invalid_argument("the " + std::string(axis) + " axis's " + row.name + " is " + std::to_string(value) +
                                  "; give " + (least ? "zero or more" : "more than zero") + ", or leave it out");
    }
  }
}

void need_positive(const char* name, double value) {
  if (std::isnan(value) || value <= 0.0 || std::isinf(value)) {
    throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) + "; give more than zero");
  }
}

}  // namespace

void check(const CommandLimits& limits) {
  check(limits.speed, "speed");
  check(limits.yaw_rate, "yaw rate");
  check(limits.side, "side");
  need_positive("the separation of the sides", limits.wheel_separation);
  need_positive("the gain of the speed", limits.gain_v);
  need_positive("the gain of the yaw rate", limits.gain_omega);
}

bool limits_sides(const CommandLimits& limits) { return limits.side != AxisLimits{}; }

bool unlimited(const CommandLimits& limits) {
  return limits.speed == AxisLimits{} && limits.yaw_rate == AxisLimits{} && !limits_sides(limits);
}

bool limits_rates(const AxisLimits& limits) {
  return std::isfinite(limits.slew_rate_up) || std::isfinite(limits.slew_rate_down);
}
bool limits_rates(const CommandLimits& limits) {
  return limits_rates(limits.speed) || limits_rates(limits.yaw_rate) || limits_rates(limits.side);
}

int ramp_pieces(double hold, double longest_piece) { return lag_parts(hold, longest_piece); }

CommandLimits channel_limits(const CommandLimits& limits) {
  return {.speed = limits.speed, .yaw_rate = limits.yaw_rate};
}

namespace {

/// Cuts ramps into held pieces. `reach` is called before each piece, with its end, and may move the ramps.
template <typename Reach>
InputHistory limited_pieces(const InputHistory& commands, CommandLimiter limiter, double longest_piece,
                            const Reach& reach) {
  std::vector<double> t;
  std::vector<BodyTwist> twist;
  t.reserve(2 * commands.size());
  twist.reserve(2 * commands.size());
  const auto push = [&](double now, const BodyTwist& given) {
    t.push_back(now);
    twist.push_back(given);
  };
  double hold = longest_piece;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    limiter.tell(commands.sample(i));
    double now = commands.time(i);
    const double next = i + 1 < commands.size() ? commands.time(i + 1) : std::numeric_limits<double>::infinity();
    hold = i > 0 ? now - commands.time(i - 1) : hold;
    if (limiter.ramps()) {
      double piece = hold / ramp_pieces(hold, longest_piece);
      if (next - now > kMostPieces * piece) {
        piece = std::max(piece, std::min(limiter.seconds_left(), kLongestRamp) / kMostPieces);
      }
      for (int k = 0; k <= kMostPieces && later(next, now); ++k) {
        const double taken = std::min(piece, next - now);
        reach(limiter, now + taken);
        if (!limiter.ramps()) {
          break;
        }
        push(now, limiter.mean_over(piece, taken));
        now += taken;
      }
    }
    if (later(next, now)) {
      push(now, limiter.target());
      if (std::isfinite(next)) {
        limiter.mean_over(next - now, next - now);
      }
    }
  }
  return {std::move(t), std::move(twist)};
}

}  // namespace

InputHistory limited_inputs(const InputHistory& commands, const CommandLimits& limits, double longest_piece) {
  need_positive("a ramp's longest piece", longest_piece);
  const CommandLimiter at_rest(limits);
  return unlimited(limits) ? commands
                           : limited_pieces(commands, at_rest, longest_piece, [](CommandLimiter&, double) {});
}

MeasuredStart measured_start(const ActuatorModel& actuator, double time, const BodyTwist& measured) {
  const AxisResponse speed = speed_response(actuator), turn = yaw_rate_response(actuator);
  return {.keeping = {speed.keeping_input(measured.v), speed.keeping_input(measured.vy),
                      turn.keeping_input(measured.omega)},
          .v_until = time - actuator.delay_v,
          .omega_until = time - actuator.delay_omega};
}

InputHistory limited_inputs(const InputHistory& commands, const CommandLimits& limits, const MeasuredStart& start,
                            double longest_piece) {
  need_positive("a ramp's longest piece", longest_piece);
  CommandLimiter limiter(limits);
  if (unlimited(limits) || commands.size() == 0) {
    return commands;
  }
  const double first = commands.time(0);
  const BodyTwist& keeping = start.keeping;
  limiter.place({first > start.v_until ? keeping.v : 0.0, 0.0, first > start.omega_until ? keeping.omega : 0.0});
  bool v = first > start.v_until, omega = first > start.omega_until;
  return limited_pieces(commands, limiter, longest_piece, [&](CommandLimiter& ramps, double end) {
    const bool v_now = !v && end > start.v_until, omega_now = !omega && end > start.omega_until;
    ramps.reach(keeping, v_now, omega_now);
    v = v || v_now;
    omega = omega || omega_now;
  });
}

}  // namespace slipwise
