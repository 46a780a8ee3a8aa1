// SPDX-License-Identifier: Apache-2.0
// Angles wrapped to one turn.
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

}  // namespace slipwise
