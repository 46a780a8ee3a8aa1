// SPDX-License-Identifier: Apache-2.0
// sin(f)/f and (1 - cos(f))/f for many lanes at once: the same power series in every lane, no branches.
#pragma once

#include <cstddef>
#include <type_traits>

#include "slipwise/lie/lane_function.hpp"

namespace slipwise {

inline constexpr double kLaneTurn = 0.4;        ///< turns up to this one take the plain series [rad]
inline constexpr double kWidestLaneTurn = 1e5;  ///< beyond it, whole turns cannot be taken off exactly [rad]

namespace lane_series {

// Plain arrays: see rollout/lane_job.hpp.
// NOLINTBEGIN(modernize-avoid-c-arrays)
/// Series in q = f^2 of sin(f)/f and (1 - cos(f))/f^2, exact to rounding for q <= kLaneTurn^2. Those of float are
/// economised: their q^3 is replaced by the polynomial of second degree that is nearest on that range (Chebyshev).
template <typename Scalar>
struct ArcSeries;
template <>
struct ArcSeries<float> {
  static constexpr double kQ = kLaneTurn * kLaneTurn;
  float a[3] = {1.0F, static_cast<float>(-1.0 / 6 + 9.0 / 16 * kQ * kQ / 5040),
                static_cast<float>(1.0 / 120 - 3.0 / 2 * kQ / 5040)};
  float b[3] = {0.5F, static_cast<float>(-1.0 / 24 + 9.0 / 16 * kQ * kQ / 40320),
                static_cast<float>(1.0 / 720 - 3.0 / 2 * kQ / 40320)};
};
template <>
struct ArcSeries<double> {
  double a[7] = {1.0, -1.0 / 6, 1.0 / 120, -1.0 / 5040, 1.0 / 362880., -1.0 / 39916800, 1.0 / 6227020800.};
  double b[7] = {1.0 / 2, -1.0 / 24, 1.0 / 720, -1.0 / 40320, 1.0 / 3628800., -1.0 / 479001600., 1.0 / 87178291200.};
};
// NOLINTEND(modernize-avoid-c-arrays)

/// A whole turn in three parts of few digits, so that multiples of the first two are exact (Cody and Waite 1980), and
/// the number whose addition rounds to an integer.
template <typename Scalar>
struct WholeTurn;
template <>
struct WholeTurn<float> {
  float inverse = 0.15915494F;
  float rounding = 12582912.0F;
  float high = 6.28125F;
  float middle = 0.0019350051879882812F;
  float low = 3.01991598e-07F;
};
template <>
struct WholeTurn<double> {
  double inverse = 0.15915494309189535;
  double rounding = 6755399441055744.0;
  double high = 6.2831853069365025;
  double middle = 2.4308402025215864e-10;
  double low = 8.089064995183803e-21;
};

}  // namespace lane_series

/// A = sin(f)/f and B = (1 - cos(f))/f of derivations/model.md; Vector holds lanes of Scalar.
template <typename Vector>
struct LaneArc {
  Vector a;
  Vector b;
};

template <typename Scalar, typename Vector>
SLIPWISE_LANES void lane_arc(const Vector& f, LaneArc<Vector>& arc) {
  constexpr lane_series::ArcSeries<Scalar> kSeries;
  const Vector q = f * f;
  if constexpr (std::is_same_v<Scalar, float>) {
    arc.a = kSeries.a[0] + q * (kSeries.a[1] + q * kSeries.a[2]);
    arc.b = f * (kSeries.b[0] + q * (kSeries.b[1] + q * kSeries.b[2]));
  } else {
    constexpr std::size_t kLast = 6;
    Vector a = Vector{} + kSeries.a[kLast];
    Vector b = Vector{} + kSeries.b[kLast];
    for (std::size_t i = kLast; i-- > 0;) {
      a = kSeries.a[i] + q * a;
      b = kSeries.b[i] + q * b;
    }
    arc.a = a;
    arc.b = f * b;
  }
}

/// The same for turns up to kWidestLaneTurn; lanes of at most kLaneTurn get the same bytes as from `lane_arc`.
template <typename Scalar, typename Vector>
SLIPWISE_LANES void wide_lane_arc(const Vector& f, LaneArc<Vector>& arc) {
  lane_arc<Scalar>(f, arc);
  constexpr lane_series::WholeTurn<Scalar> kTurn;
  const Vector whole = (f * kTurn.inverse + kTurn.rounding) - kTurn.rounding;
  const Vector rest = ((f - whole * kTurn.high) - whole * kTurn.middle) - whole * kTurn.low;
  constexpr int kDoublings = 3;  // from a sixteenth of the rest, at most 0.2 rad, to its half
  const Vector part = rest * static_cast<Scalar>(1.0 / 16.0);
  LaneArc<Vector> of_part;
  lane_arc<Scalar>(part, of_part);
  Vector s = part * of_part.a;
  Vector c = static_cast<Scalar>(1) - part * of_part.b;
  for (int i = 0; i < kDoublings; ++i) {
    const Vector twice = s + s;
    const Vector cosine = static_cast<Scalar>(1) - twice * s;
    s = twice * c;
    c = cosine;
  }
  const auto wide = f * f > static_cast<Scalar>(kLaneTurn * kLaneTurn);
  arc.a = wide ? (s + s) * c / f : arc.a;
  arc.b = wide ? (s + s) * s / f : arc.b;
}

}  // namespace slipwise
