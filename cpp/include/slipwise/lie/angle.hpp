// SPDX-License-Identifier: Apache-2.0
// Angles on the real line: wrapping to one turn, and choosing the branch nearest to a reference.
#pragma once

#include <cmath>
#include <numbers>

namespace slipwise {

/// The angle in (-pi, pi] that differs from `angle` [rad] by whole turns.
inline double wrap_angle(double angle) {
  if (std::abs(angle) < std::numbers::pi) {
    return angle;  // as the remainder is, which takes as long as a sine
  }
  const double wrapped = std::remainder(angle, 2.0 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

/// `angle` [rad] shifted by whole turns so that it lies within half a turn of `reference` [rad].
inline double unwrap_near(double angle, double reference) { return reference + wrap_angle(angle - reference); }

}  // namespace slipwise
