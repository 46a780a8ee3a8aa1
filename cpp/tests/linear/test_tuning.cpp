// SPDX-License-Identifier: Apache-2.0
// Factors of tuning constants are read by name, in the build for sensitivity alone.
#define SLIPWISE_SENSITIVITY
#include "slipwise/linear/tuning.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdlib>

namespace slipwise {
namespace {

struct Given {
  explicit Given(const char* factors) { setenv("SLIPWISE_TUNING", factors, 1); }
  ~Given() { unsetenv("SLIPWISE_TUNING"); }
  Given(const Given&) = delete;
  Given& operator=(const Given&) = delete;
  Given(Given&&) = delete;
  Given& operator=(Given&&) = delete;
};

TEST_CASE("a constant without a factor is itself") {
  CHECK(tuned("/a/filter.cpp", "kGain", 0.3) == 0.3);
  const Given given("other.kGain=2,filter.kGains=3,filters.kGain=4,filter.kGai=5");
  CHECK(tuned("/a/filter.cpp", "kGain", 0.3) == 0.3);
}

TEST_CASE("a constant is multiplied by the factor of its file and name") {
  const Given given("other.kGain=2,filter.kGain=0.5,filter.kCount=0.25");
  CHECK(tuned("/a/b/filter.cpp", "kGain", 0.3) == 0.15);
  CHECK(tuned("other.hpp", "kGain", 0.3) == 0.6);
  CHECK(tuned("filter.hpp", "kCount", 10) == 3);
}

TEST_CASE("what counts stays at least one") {
  const Given given("filter.kCount=0.001");
  CHECK(tuned("filter.cpp", "kCount", std::size_t{8}) == 1);
}

TEST_CASE("a declaration names its own file") {
  const Given given("test_tuning.kHere=2");
  SLIPWISE_TUNING(kHere, 1.5);
  CHECK(kHere == 3.0);
}

}  // namespace
}  // namespace slipwise
