// SPDX-License-Identifier: Apache-2.0
// Coloured noise has unit variance, the stated correlation, and follows its seed.
#include <doctest/doctest.h>

#include <cmath>

#include "slipwise/planning/coloured_noise.hpp"

namespace slipwise {
namespace {

TEST_CASE("coloured noise has mean zero, unit variance and the stated correlation at every step") {
  constexpr std::size_t kLanes = 40000;
  constexpr float kCorrelation = 0.8F;
  ColouredNoise noise(kLanes, kCorrelation, 7);
  std::vector<float> before(kLanes, 0.0F);
  for (int step = 0; step < 5; ++step) {
    const std::vector<float>& now = noise.next();
    double sum = 0.0, squares = 0.0, products = 0.0;
    for (std::size_t i = 0; i < kLanes; ++i) {
      sum += now[i];
      squares += static_cast<double>(now[i]) * now[i];
      products += static_cast<double>(now[i]) * before[i];
    }
    CHECK(std::abs(sum / kLanes) < 0.02);
    CHECK(squares / kLanes == doctest::Approx(1.0).epsilon(0.03));
    if (step > 0) {
      CHECK(products / kLanes == doctest::Approx(kCorrelation).epsilon(0.04));
    }
    before = now;
  }
}

TEST_CASE("coloured noise is the same for the same seed, and lanes differ") {
  ColouredNoise one(64, 0.5F, 3), same(64, 0.5F, 3), other(64, 0.5F, 4);
  const std::vector<float> first = one.next();
  CHECK(first == same.next());
  CHECK(first != other.next());
  CHECK(first[0] != first[1]);
  one.begin();
  CHECK(std::abs(one.next()[0]) < 3.5F);
}

}  // namespace
}  // namespace slipwise
