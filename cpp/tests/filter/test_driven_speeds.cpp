// SPDX-License-Identifier: Apache-2.0
// Reference speeds are what the robot drove at most of its moving time, and never too small to mean something.
// So holds speed_range.
#include <doctest/doctest.h>

#include <vector>

#include "slipwise/filter/driven_speeds.hpp"

namespace slipwise {
namespace {

InputHistory drive(const std::vector<double>& t, const std::vector<double>& v, const std::vector<double>& omega) {
  const std::vector<double> vy(t.size(), 0.0);
  return {t, v, vy, omega};
}

TEST_CASE("before anything was driven, and at a crawl, the references are the least ones") {
  DrivenSpeeds speeds;
  CHECK(speeds.reference().v == 0.05);
  CHECK(speeds.reference().omega == 0.05);
  speeds.see(drive({0.0}, {0.01}, {0.002}), {.start = 0.0, .end = 100.0});
  CHECK(speeds.reference().v == 0.05);
}

TEST_CASE("the reference is the speed below which nine tenths of the moving time lie, backwards as forwards") {
  const InputHistory inputs = drive({0.0, 80.0, 95.0, 100.0}, {-0.5, 1.0, 4.0, 0.0}, {0.2, -0.8, 0.0, 0.0});
  DrivenSpeeds speeds;
  speeds.see(inputs, {.start = 0.0, .end = 1000.0});  // standstill does not count
  CHECK(speeds.reference().v == doctest::Approx(1.0).epsilon(0.05));
  CHECK(speeds.reference().omega == doctest::Approx(0.8).epsilon(0.05));
}

TEST_CASE("only the time of the segments counts") {
  const InputHistory inputs = drive({0.0, 10.0}, {0.4, 3.0}, {0.0, 0.0});
  DrivenSpeeds speeds;
  speeds.see(inputs, {.start = 0.0, .end = 10.0});
  CHECK(speeds.reference().v == doctest::Approx(0.4).epsilon(0.05));
  speeds.see(inputs, {.start = 10.0, .end = 20.0});
  CHECK(speeds.reference().v == doctest::Approx(3.0).epsilon(0.05));
}

}  // namespace
}  // namespace slipwise
