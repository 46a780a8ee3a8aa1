// SPDX-License-Identifier: Apache-2.0
// From profiles to held commands, with derivatives.
#include "slipwise/planning/manoeuvre.hpp"

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

}  // namespace

HeldCommands held_commands(const ManoeuvreFrame& frame, const ManoeuvreVector& parameters) {
  const SpeedProfile profile(frame.speeds, frame.acceleration, parameters[kLength]);
  const double count = frame.commands;
  const ByLength duration = profile.duration();
  HeldCommands held{.period = {duration.value / count, duration.slope / count}, .commands = {}};
  held.commands.reserve(static_cast<std::size_t>(frame.commands) + 1);
  ByLength before{0.0, 0.0};
  for (int k = 0; k < frame.commands; ++k) {
    const ByLength after = profile.distance((k + 1) / count);
    const double speed = (after.value - before.value) / held.period.value;
    const double slope = (after.slope - before.slope - speed * held.period.slope) / held.period.value;
    held.commands.push_back(command(frame.direction * speed, frame.direction * slope, (k + 0.5) / count, parameters));
    before = after;
  }
  held.commands.push_back(command(frame.direction * frame.speeds.end, 0.0, 1.0, parameters));
  return held;
}

}  // namespace slipwise
