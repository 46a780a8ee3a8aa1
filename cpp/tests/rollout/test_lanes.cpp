// SPDX-License-Identifier: Apache-2.0
// Vectors and pairs of vectors do in every lane what one number does.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "slipwise/rollout/lanes.hpp"

namespace slipwise {
namespace {

struct Level {
  static constexpr std::size_t kBytes = 16, kPairs = 2;
};
using Wide = Lanes<Level, double>;
constexpr std::size_t kLanes = 8;  // two numbers of a vector, in pairs of pairs
static_assert(Wide::kLanes == kLanes);
static_assert(Lanes<Level, float>::kLanes == 2 * kLanes);

constexpr std::array<double, kLanes> kA{1.0, -2.0, 0.0, 3.5, -0.25, 0.0, 7.0, -8.0};
constexpr std::array<double, kLanes> kB{2.0, -1.0, 0.0, 3.5, 4.0, -5.0, -7.0, 0.5};

Wide::Vector lanes_of(const std::array<double, kLanes>& numbers) {
  Wide::Vector vector;
  load(numbers.data(), vector);
  return vector;
}

template <typename OfNumbers>
void check_lanes(const Wide::Vector& got, const OfNumbers& wanted) {
  std::array<double, kLanes> numbers{};
  store(got, numbers.data());
  for (std::size_t i = 0; i < kLanes; ++i) {
    CAPTURE(i);
    CHECK(numbers[i] == wanted(kA[i], kB[i]));
  }
}

TEST_CASE("what is loaded is stored again, lane by lane; a copy and a filled vector too") {
  check_lanes(lanes_of(kA), [](double a, double) { return a; });
  Wide::Vector copied, filled;
  copy(lanes_of(kB), copied);
  fill(2.5, filled);
  check_lanes(copied, [](double, double b) { return b; });
  check_lanes(filled, [](double, double) { return 2.5; });
}

TEST_CASE("arithmetic of lanes is that of their numbers") {
  const Wide::Vector a = lanes_of(kA), b = lanes_of(kB);
  check_lanes(a + b, [](double x, double y) { return x + y; });
  check_lanes(a - b, [](double x, double y) { return x - y; });
  check_lanes(a * b, [](double x, double y) { return x * y; });
  check_lanes(b / (a * a + 1.0), [](double x, double y) { return y / (x * x + 1.0); });
  check_lanes(a * 3.0 - 0.5, [](double x, double) { return x * 3.0 - 0.5; });
}

TEST_CASE("comparisons choose in each lane by itself") {
  const Wide::Vector a = lanes_of(kA), b = lanes_of(kB);
  Wide::Vector one;
  fill(1.0, one);
  check_lanes(larger(a, b), [](double x, double y) { return std::max(x, y); });
  check_lanes(smaller(a, b), [](double x, double y) { return std::min(x, y); });
  check_lanes(magnitude(a), [](double x, double) { return std::abs(x); });
  check_lanes(sign(a, one), [](double x, double) { return x > 0.0 ? 1.0 : (x < 0.0 ? -1.0 : 0.0); });
  check_lanes(any_nonzero(a, b, one), [](double x, double y) { return x != 0.0 || y != 0.0 ? 1.0 : 0.0; });
}

}  // namespace
}  // namespace slipwise
