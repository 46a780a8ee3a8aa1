// SPDX-License-Identifier: Apache-2.0
// Records of drives with known limits: random steps of commands, and noisy wheel speeds behind limits, delay and lag.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "slipwise/actuator/actuator_output.hpp"
#include "slipwise/identify/limited_actuator_fit.hpp"

namespace slipwise::tests {

inline constexpr double kLimitedSeparation = 1.3;  ///< [m]
inline const ActuatorModel kLimitedChain{
    .time_constant_v = 0.4, .time_constant_omega = 0.25, .delay_v = 0.16, .delay_omega = 0.1};

/// How quickly a speed itself may change, away from zero and towards it [m/s^2].
struct DriveRates {
  double up, down;
};

/// The speed of a drive whose rates are behind its lag, in steps of 0.1 ms, at the times of the commands [s].
inline std::vector<double> rated_speed(const InputHistory& commands, const ActuatorModel& actuator,
                                       const DriveRates& rates) {
  constexpr double kStep = 1e-4;
  std::vector<double> speed{0.0};
  double v = 0.0;
  for (std::size_t i = 1; i < commands.size(); ++i) {
    const long end = std::lround(commands.time(i) / kStep);
    for (long k = std::lround(commands.time(i - 1) / kStep); k < end; ++k) {
      const double t = (static_cast<double>(k) + 0.5) * kStep;
      const double gap = commands.at(t - actuator.delay_v).v - v;
      const double most = gap * v < 0.0 ? rates.down : rates.up;
      v += kStep * std::clamp(gap / actuator.time_constant_v, -most, most);
    }
    speed.push_back(v);
  }
  return speed;
}

/// Commands at 20 Hz that are held for 1 to 3 s each.
inline InputHistory step_commands(std::mt19937& random, double seconds, double fastest) {
  constexpr double kPeriod = 0.05;  // [s]
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> t, v, omega;
  double until = 0.0;
  for (int i = 0; i * kPeriod < seconds; ++i) {
    const double now = i * kPeriod;
    const bool next = now >= until;
    until = next ? now + 2.0 + uniform(random) : until;
    t.push_back(now);
    v.push_back(next ? fastest * uniform(random) : v.back());
    omega.push_back(next ? fastest * uniform(random) : omega.back());
  }
  return {t, v, std::vector<double>(t.size(), 0.0), omega};
}

/// A record of commands, and of noisy wheels that do what `drive` does at their times.
inline WheelRecord noisy_record(const InputHistory& commands, const ActuatorOutput& drive, std::mt19937& random) {
  std::normal_distribution<double> normal(0.0, 1.0);
  WheelRecord record{.commands = commands, .t = {}, .wheels = {}};
  for (std::size_t i = 0; i < commands.size(); ++i) {
    record.t.push_back(commands.time(i));
    record.wheels.push_back(
        {.v = drive.v[i] + 0.02 * normal(random), .vy = 0.0, .omega = drive.omega[i] + 0.03 * normal(random)});
  }
  return record;
}

inline std::vector<double> times_of(const InputHistory& commands) {
  std::vector<double> t;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    t.push_back(commands.time(i));
  }
  return t;
}

inline WheelRecord limited_record(const CommandLimits& limits, unsigned seed, double seconds = 60.0,
                                  double fastest = 2.0) {
  std::mt19937 random(seed);
  const InputHistory commands = step_commands(random, seconds, fastest);
  return noisy_record(commands,
                      actuator_output(limited_inputs(commands, limits), kLimitedChain, times_of(commands), {}), random);
}

/// A record of a drive whose speed itself cannot change more quickly, behind its lag.
inline WheelRecord rated_record(const ActuatorModel& actuator, const DriveRates& rates, unsigned seed) {
  std::mt19937 random(seed);
  const InputHistory commands = step_commands(random, 60.0, 1.0);
  ActuatorOutput drive = actuator_output(commands, actuator, times_of(commands), {});
  drive.v = rated_speed(commands, actuator, rates);
  return noisy_record(commands, drive, random);
}

}  // namespace slipwise::tests
