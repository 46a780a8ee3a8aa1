// SPDX-License-Identifier: Apache-2.0
// sin(f)/f and its friends, exact to rounding at every angle; no other place tests for small angles.
#pragma once

#include <cmath>
#include <type_traits>

namespace slipwise {

/// The functions that carry a constant twist over a turn of f [rad] into a displacement (derivations/model.md).
template <typename Scalar>
struct ArcFunctions {
  Scalar a;         ///< sin(f) / f
  Scalar b;         ///< (1 - cos(f)) / f
  Scalar da;        ///< derivative of a
  Scalar db;        ///< derivative of b
  Scalar sin_turn;  ///< sin(f)
  Scalar cos_turn;  ///< cos(f)
};

/// Below this turn [rad] the power series are more exact than the closed forms.
template <typename Scalar>
inline constexpr Scalar kSmallTurn = std::is_same_v<Scalar, float> ? Scalar(0.35) : Scalar(0.03);

template <typename Scalar>
ArcFunctions<Scalar> arc_functions(Scalar f) {
  const Scalar q = f * f;
  if (std::abs(f) < kSmallTurn<Scalar>) {
    const Scalar a = 1 - q / 6 * (1 - q / 20 * (1 - q / 42));
    const Scalar b = f / 2 * (1 - q / 12 * (1 - q / 30 * (1 - q / 56)));
    const Scalar da = -f / 3 * (1 - q / 10 * (1 - q / 28 * (1 - q / 54)));
    const Scalar db = Scalar(0.5) - q / 8 * (1 - q / 18 * (1 - q / 40));
    return {a, b, da, db, f * a, 1 - f * b};
  }
  const Scalar half_sin = std::sin(f / 2);
  const Scalar half_cos = std::cos(f / 2);
  const Scalar s = 2 * half_sin * half_cos;
  const Scalar one_minus_c = 2 * half_sin * half_sin;
  const Scalar c = 1 - one_minus_c;
  const Scalar per_f = 1 / f;
  const Scalar a = s * per_f;
  const Scalar b = one_minus_c * per_f;
  return {a, b, (c - a) * per_f, (s - b) * per_f, s, c};
}

}  // namespace slipwise
