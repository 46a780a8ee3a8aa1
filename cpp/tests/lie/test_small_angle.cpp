// SPDX-License-Identifier: Apache-2.0
// The arc functions against long double, near zero and on both sides of the threshold.
#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <vector>

#include "slipwise/lie/small_angle.hpp"

namespace slipwise {
namespace {

/// Power series in long double up to half a turn, closed forms beyond.
ArcFunctions<long double> exact_arc(long double f) {
  const long double s = std::sin(f), c = std::cos(f);
  if (std::abs(f) > 0.5L) {
    const long double h = std::sin(f / 2);
    const long double b = 2 * h * h / f;
    return {s / f, b, (c - s / f) / f, (s - b) / f, s, c};
  }
  ArcFunctions<long double> arc{0, 0, 0, 0, s, c};
  long double power = 1;  // f^(2n) / (2n)! with the sign (-1)^n
  for (int n = 0; n < 15; ++n) {
    const long double odd = 2 * n + 1, even = 2 * n + 2;
    arc.a += power / odd;
    arc.b += power * f / (odd * even);
    arc.db += power / even;
    power *= -f * f / (odd * even);
    arc.da += power * even / f / (even + 1);
  }
  return arc;
}

template <typename Scalar>
double worst_error(Scalar f) {
  const ArcFunctions<Scalar> arc = arc_functions(f);
  const ArcFunctions<long double> exact = exact_arc(static_cast<long double>(f));
  double worst = 0.0;
  const auto look = [&](Scalar got, long double want) {
    worst = std::max(worst, static_cast<double>(std::abs(static_cast<long double>(got) - want)));
  };
  look(arc.a, exact.a);
  look(arc.b, exact.b);
  look(arc.da, exact.da);
  look(arc.db, exact.db);
  look(arc.sin_turn, exact.sin_turn);
  look(arc.cos_turn, exact.cos_turn);
  return worst;
}

template <typename Scalar>
std::vector<Scalar> sample_turns() {
  const Scalar edge = kSmallTurn<Scalar>;
  std::vector<Scalar> turns;
  for (const Scalar f :
       {Scalar(1e-30), Scalar(1e-9), Scalar(1e-4), Scalar(0.01), edge / 2, std::nextafter(edge, Scalar(0)), edge,
        std::nextafter(edge, Scalar(1)), 2 * edge, Scalar(0.7), Scalar(3.1), Scalar(9.4)}) {
    turns.push_back(f);
    turns.push_back(-f);
  }
  return turns;
}

TEST_CASE("arc functions are exact in double on both sides of the small-angle threshold") {
  for (const double f : sample_turns<double>()) {
    CAPTURE(f);
    CHECK(worst_error(f) < 1e-14);
  }
}

TEST_CASE("arc functions are exact in float on both sides of the small-angle threshold") {
  for (const float f : sample_turns<float>()) {
    CAPTURE(f);
    CHECK(worst_error(f) < 4e-7);
  }
}

TEST_CASE("the series of the arc functions stay within 3e-8 in float arithmetic's own rounding") {
  for (const double f : {0.05, 0.2, 0.349}) {
    CAPTURE(f);
    CHECK(worst_error(static_cast<float>(f)) < 3e-8 + 6e-8);  // the series' remainder and one rounding near one
  }
}

TEST_CASE("a straight line keeps its length") {
  const auto arc = arc_functions(0.0);
  CHECK(arc.a == 1.0);
  CHECK(arc.b == 0.0);
  CHECK(arc.da == 0.0);
  CHECK(arc.db == 0.5);
  CHECK(arc.sin_turn == 0.0);
  CHECK(arc.cos_turn == 1.0);
}

}  // namespace
}  // namespace slipwise
