// SPDX-License-Identifier: Apache-2.0
// From profiles to held commands, with derivatives.
#include "slipwise/planning/manoeuvre.hpp"

#include <algorithm>
#include <cmath>

#include "slipwise/actuator/command_limiter.hpp"

namespace slipwise {
namespace {

HeldCommand command(double v, double v_by_length, double fraction, const ManoeuvreVector& parameters) {
  const CurvatureWeights weights = curvature_weights(fraction);
  const double curvature = weights.dot(parameters.head<kCurvaturePoints>());
  HeldCommand held{.v = v, .omega = curvature * v, .v_by_length = v_by_length};
  held.omega_by.head<kCurvaturePoints>() = weights * v;
  held.omega_by[kLength] = curvature * v_by_length;
  return held;
}

constexpr double kLongestRamp = 100.0;  // [s]; no robot waits longer at a goal

bool holds(const AxisLimits& limits, double command) {
  return std::abs(command) < limits.dead_band || std::abs(command) > limits.saturation;
}

/// Without the derivatives of what dead-band or top hold.
HeldCommand passed(HeldCommand command, const CommandLimits& limits) {
  if (holds(limits.speed, command.v)) {
    command.v_by_length = 0.0;
  }
  if (holds(limits.yaw_rate, command.omega)) {
    command.omega_by.setZero();
  }
  return command;
}

}  // namespace

HeldCommands held_commands(const ManoeuvreFrame& frame, const ManoeuvreVector& parameters) {
  const SpeedProfile profile(frame.speeds, frame.acceleration, parameters[kLength]);
  const double count = frame.commands;
  const ByLength duration = profile.duration();
  HeldCommands held{.period = {duration.value / count, duration.derivative / count},
                    .commands = {},
                    .end = static_cast<std::size_t>(frame.commands),
                    .settling = frame.settling};
  held.commands.reserve(static_cast<std::size_t>(frame.commands) + 1);
  ByLength before{0.0, 0.0};
  for (int k = 0; k < frame.commands; ++k) {
    const ByLength after = profile.distance((k + 1) / count);
    const double speed = (after.value - before.value) / held.period.value;
    const double derivative =
        (after.derivative - before.derivative - speed * held.period.derivative) / held.period.value;
    held.commands.push_back(
        command(frame.direction * speed, frame.direction * derivative, (k + 0.5) / count, parameters));
    before = after;
  }
  held.commands.push_back(command(frame.direction * frame.speeds.end, 0.0, 1.0, parameters));
  return held;
}

HeldCommands limited_commands(const HeldCommands& held, const CommandLimits& limits, const BodyTwist& commanded) {
  if (unlimited(limits)) {
    return held;
  }
  CommandLimiter limiter(limits);
  limiter.settle(commanded);
  const int pieces = limits_rates(limits) ? ramp_pieces(held.period.value) : 1;
  const double piece = held.period.value / pieces;
  HeldCommands result{.period = {piece, held.period.derivative / pieces},
                      .commands = {},
                      .end = held.end * static_cast<std::size_t>(pieces),
                      .settling = held.settling};
  const auto add = [&](HeldCommand command) {
    const BodyTwist mean = limiter.mean_over(piece, piece);
    command.v = mean.v;
    command.omega = mean.omega;
    result.commands.push_back(command);
  };
  for (std::size_t k = 0; k < held.end; ++k) {
    limiter.tell({held.commands[k].v, 0.0, held.commands[k].omega});
    for (int i = 0; i < pieces; ++i) {
      add(passed(held.commands[k], limits));
    }
  }
  const HeldCommand& last = held.commands[held.end];
  limiter.tell({last.v, 0.0, last.omega});
  const double ramp = std::min(limiter.seconds_left(), kLongestRamp);
  result.settling += ramp;
  const auto after = static_cast<std::size_t>(std::ceil(ramp / piece));
  for (std::size_t i = 0; i <= after; ++i) {
    add(passed(last, limits));
  }
  return result;
}

}  // namespace slipwise
