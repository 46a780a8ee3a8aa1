// SPDX-License-Identifier: Apache-2.0
// The arc functions of lanes against the plain ones, over small turns, wide turns and both numbers.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "slipwise/lie/lane_arc.hpp"

namespace slipwise {
namespace {

// Two lanes of double, and four of float.
typedef double Doubles __attribute__((vector_size(16)));
typedef float Floats __attribute__((vector_size(16)));

template <typename Scalar>
double worst_of(const LaneArc<Scalar>& arc, Scalar f) {
  const auto turn = static_cast<long double>(f);
  const long double half = std::sin(turn / 2);
  const long double a = turn == 0 ? 1 : std::sin(turn) / turn;
  const long double b = turn == 0 ? 0 : 2 * half * half / turn;
  return static_cast<double>(
      std::max(std::abs(static_cast<long double>(arc.a) - a), std::abs(static_cast<long double>(arc.b) - b)));
}

template <typename Scalar, typename Vector>
double worst_wide(double turn) {
  const auto f = static_cast<Scalar>(turn);
  LaneArc<Vector> arc;
  wide_lane_arc<Scalar>(Vector{} + f, arc);
  return worst_of<Scalar>({arc.a[1], arc.b[1]}, f);
}

TEST_CASE("the plain series of lanes are exact to rounding up to their widest turn") {
  for (int i = -100; i <= 100; ++i) {
    const double f = kLaneTurn * i / 100.0;
    CAPTURE(f);
    LaneArc<Doubles> fine;
    lane_arc<double>(Doubles{} + f, fine);
    CHECK(worst_of<double>({fine.a[0], fine.b[0]}, f) < 3e-16);
    const auto g = static_cast<float>(f);
    LaneArc<Floats> coarse;
    lane_arc<float>(Floats{} + g, coarse);
    CHECK(worst_of<float>({coarse.a[0], coarse.b[0]}, g) < 1.2e-7);
  }
}

TEST_CASE("wide turns of lanes, many times round and of both signs, are exact to rounding") {
  for (const double turn : {0.41, 1.0, 3.1, 3.2, 6.2831853, 6.3, 40.0, 1234.5, 99999.0}) {
    for (const double f : {turn, -turn}) {
      CAPTURE(f);
      CHECK(worst_wide<double, Doubles>(f) < 1e-15);
      CHECK(worst_wide<float, Floats>(f) < 4e-7);
    }
  }
}

TEST_CASE("a small turn gives the same bytes beside a wide one as alone") {
  for (const double small : {0.0, 1e-9, -0.2, 0.399}) {
    const Doubles mixed{small, 3.0};
    LaneArc<Doubles> wide, plain;
    wide_lane_arc<double>(mixed, wide);
    lane_arc<double>(mixed, plain);
    CHECK(wide.a[0] == plain.a[0]);
    CHECK(wide.b[0] == plain.b[0]);
    CHECK(wide.a[1] != plain.a[1]);
  }
}

}  // namespace
}  // namespace slipwise
