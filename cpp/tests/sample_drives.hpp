// SPDX-License-Identifier: Apache-2.0
// Inputs of made-up drives: smooth, held for long, turning in place, spinning; at generic times, away from kinks.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "slipwise/actuator/input_history.hpp"

namespace slipwise::tests {

/// The twist that a drive commands at a time.
using TwistOfTime = BodyTwist (*)(double t);

/// Samples a drive every `period` seconds from `first` on, `count` times.
inline InputHistory sampled(TwistOfTime drive, double first, double period, std::size_t count) {
  std::vector<double> t, v, vy, omega;
  for (std::size_t i = 0; i < count; ++i) {
    t.push_back(first + period * static_cast<double>(i));
    const BodyTwist twist = drive(t.back());
    v.push_back(twist.v);
    vy.push_back(twist.vy);
    omega.push_back(twist.omega);
  }
  return {t, v, vy, omega};
}

struct SampleDrive {
  std::string name;
  TwistOfTime twist;
};

/// Each starts at a twist away from zero, so that signs do not change where derivatives are taken.
inline std::vector<SampleDrive> sample_drives() {
  return {
      {"forward",
       [](double t) { return BodyTwist{1.1 + 0.4 * std::sin(1.3 * t), 0.0, 0.5 + 0.3 * std::cos(0.9 * t)}; }},
      {"reverse", [](double t) { return BodyTwist{-0.8 - 0.3 * std::sin(0.7 * t), 0.0, -0.4 + 0.2 * std::sin(t)}; }},
      {"turning in place", [](double t) { return BodyTwist{0.0, 0.0, 0.9 + 0.4 * std::sin(1.1 * t)}; }},
      {"spinning", [](double t) { return BodyTwist{0.3 + 0.1 * std::cos(t), 0.0, 4.0 + std::sin(2.0 * t)}; }},
      {"sideways too",
       [](double t) { return BodyTwist{0.7, 0.3 + 0.2 * std::sin(t), -0.6 + 0.1 * std::cos(3.0 * t)}; }},
  };
}

}  // namespace slipwise::tests
