// SPDX-License-Identifier: Apache-2.0
// sin(f)/f and (1 - cos(f))/f for many lanes at once: the same power series in every lane, no branches.
#pragma once

#include <cstddef>
#include <type_traits>

namespace slipwise {

/// Turns up to this one [rad] take the plain series, and up to `kWidestLaneTurn` their doubling.
inline constexpr double kLaneTurn = 0.4;
inline constexpr int kLaneDoublings = 4;
inline constexpr double kWidestLaneTurn = kLaneTurn * (1 << kLaneDoublings);  ///< more than a whole turn

namespace lane_series {

/// Series in q = f^2 of sin(f)/f and (1 - cos(f))/f^2, exact to rounding for q <= kLaneTurn^2. Those of float are
/// economised: their q^3 is replaced by the polynomial of second degree that is nearest on that range (Chebyshev).
inline constexpr double kQ = kLaneTurn * kLaneTurn;
inline constexpr float kFloatA[] = {1.0F, static_cast<float>(-1.0 / 6 + 9.0 / 16 * kQ * kQ / 5040),
                                    static_cast<float>(1.0 / 120 - 3.0 / 2 * kQ / 5040)};
inline constexpr float kFloatB[] = {0.5F, static_cast<float>(-1.0 / 24 + 9.0 / 16 * kQ * kQ / 40320),
                                    static_cast<float>(1.0 / 720 - 3.0 / 2 * kQ / 40320)};
inline constexpr double kDoubleA[] = {1.0,           -1.0 / 6,        1.0 / 120,        -1.0 / 5040,
                                      1.0 / 362880., -1.0 / 39916800, 1.0 / 6227020800.};
inline constexpr double kDoubleB[] = {1.0 / 2,        -1.0 / 24,         1.0 / 720,         -1.0 / 40320,
                                      1.0 / 3628800., -1.0 / 479001600., 1.0 / 87178291200.};

}  // namespace lane_series

/// A = sin(f)/f and B = (1 - cos(f))/f of derivations.md, section 2; Vector holds lanes of Scalar.
template <typename Vector>
struct LaneArc {
  Vector a;
  Vector b;
};

template <typename Scalar, typename Vector>
[[gnu::always_inline]] inline void lane_arc(const Vector& f, LaneArc<Vector>& arc) {
  const Vector q = f * f;
  if constexpr (std::is_same_v<Scalar, float>) {
    using namespace lane_series;
    arc.a = kFloatA[0] + q * (kFloatA[1] + q * kFloatA[2]);
    arc.b = f * (kFloatB[0] + q * (kFloatB[1] + q * kFloatB[2]));
  } else {
    constexpr std::size_t kLast = 6;
    Vector a = Vector{} + lane_series::kDoubleA[kLast];
    Vector b = Vector{} + lane_series::kDoubleB[kLast];
    for (std::size_t i = kLast; i-- > 0;) {
      a = lane_series::kDoubleA[i] + q * a;
      b = lane_series::kDoubleB[i] + q * b;
    }
    arc.a = a;
    arc.b = f * b;
  }
}

/// The same for turns up to kWidestLaneTurn; lanes of at most kLaneTurn get the same bytes as from `lane_arc`.
template <typename Scalar, typename Vector>
[[gnu::always_inline]] inline void wide_lane_arc(const Vector& f, LaneArc<Vector>& arc) {
  lane_arc<Scalar>(f, arc);
  const Vector part = f * static_cast<Scalar>(1.0 / (1 << kLaneDoublings));
  LaneArc<Vector> doubled;
  lane_arc<Scalar>(part, doubled);
  Vector s = part * doubled.a;
  Vector c = static_cast<Scalar>(1) - part * doubled.b;
  for (int i = 0; i < kLaneDoublings; ++i) {  // A(2f) = A(f) cos f and B(2f) = A(f) sin f
    doubled.b = doubled.a * s;
    doubled.a = doubled.a * c;
    const Vector twice = static_cast<Scalar>(2) * s;
    s = twice * c;
    c = static_cast<Scalar>(1) - twice * (twice * static_cast<Scalar>(0.5));
  }
  const auto wide = f * f > static_cast<Scalar>(kLaneTurn * kLaneTurn);
  arc.a = wide ? doubled.a : arc.a;
  arc.b = wide ? doubled.b : arc.b;
}

}  // namespace slipwise
