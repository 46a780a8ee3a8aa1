// SPDX-License-Identifier: Apache-2.0
// Records of drives with known limits: random steps of commands, and noisy wheel speeds behind limits, delay and lag.
#pragma once

#include <cstddef>
#include <random>
#include <vector>

#include "slipwise/actuator/actuator_output.hpp"
#include "slipwise/identify/limited_actuator_fit.hpp"

namespace slipwise::tests {

inline constexpr double kLimitedSeparation = 1.3;  ///< [m]
inline const ActuatorModel kLimitedChain{
    .time_constant_v = 0.4, .time_constant_omega = 0.25, .delay_v = 0.16, .delay_omega = 0.1};

/// A record at 20 Hz of commands that are held for 1 to 3 s each.
inline WheelRecord limited_record(const CommandLimits& limits, unsigned seed, double seconds = 60.0,
                                  double fastest = 2.0) {
  constexpr double kPeriod = 0.05;  // [s]
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> normal(0.0, 1.0);
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
  const InputHistory commands(t, v, std::vector<double>(t.size(), 0.0), omega);
  const ActuatorOutput drive = actuator_output(limited_inputs(commands, limits), kLimitedChain, t, {});
  std::vector<BodyTwist> wheels;
  for (std::size_t i = 0; i < t.size(); ++i) {
    wheels.push_back(
        {.v = drive.v[i] + 0.02 * normal(random), .vy = 0.0, .omega = drive.omega[i] + 0.03 * normal(random)});
  }
  return {commands, t, wheels};
}

}  // namespace slipwise::tests
