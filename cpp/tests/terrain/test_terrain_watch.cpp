// SPDX-License-Identifier: Apache-2.0
// Windows are answered as soon as they are complete, with what they have.
#include "slipwise/terrain/terrain_watch.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "terrain/sample_terrain.hpp"

namespace slipwise {
namespace {

constexpr TerrainCutting kCutting{.seconds = 2.0, .imu_rate = 50.0, .drive_rate = 10.0};

TerrainWatch watch() { return {tests::classifier(VibrationBands(50.0).edges().size() * kImuAxes), kCutting, 1.0}; }

std::array<double, kImuAxes> shaking(double t) { return {std::sin(40.0 * t), 0.0, 0.0, 0.0, 0.0, 9.8}; }

TEST_CASE("a window of both streams is answered once both have passed its end") {
  TerrainWatch both = watch();
  for (int i = 0; i <= 110; ++i) {
    const double t = 0.02 * i;
    both.push_imu(t, shaking(t));
    if (i % 5 == 0 && t <= 1.95) {
      both.push_drive(t, {5.0, 5.0, 0.5, 0.5});
    }
  }
  CHECK(both.take_answers().empty());
  both.push_drive(2.0, {5.0, 5.0, 0.5, 0.5});
  const auto answers = both.take_answers();
  REQUIRE(answers.size() == 1);
  CHECK(answers.front().start == 0.0);
  CHECK(answers.front().end == 2.0);
  CHECK(answers.front().answer.probability.sum() == doctest::Approx(1.0));
  CHECK(both.take_answers().empty());
}

TEST_CASE("a stream that stays behind is not waited for longer than half a second") {
  TerrainWatch alone = watch();
  alone.push_drive(0.0, {5.0, 5.0, 0.5, 0.5});
  for (int i = 0; i <= 250; ++i) {
    alone.push_imu(0.02 * i, shaking(0.02 * i));
  }
  const auto answers = alone.take_answers();
  REQUIRE(answers.size() == 3);
  CHECK(answers[1].start == 1.0);
}

TEST_CASE("samples that are not finite or go back are left out, and a long silence begins again") {
  TerrainWatch some = watch();
  some.push_imu(0.0, shaking(0.0));
  some.push_imu(std::numeric_limits<double>::quiet_NaN(), shaking(0.0));
  some.push_imu(-1.0, shaking(0.0));
  some.push_drive(0.1, {std::numeric_limits<double>::infinity(), 0.0, 0.0, 0.0});
  CHECK(some.left_out() == 3);
  some.push_imu(1e9, shaking(0.0));
  CHECK(some.take_answers().empty());
}

TEST_CASE("samples at another rate than in training say nothing") {
  TerrainWatch slow = watch();
  for (int i = 0; i <= 200; ++i) {
    slow.push_imu(0.03 * i, shaking(0.03 * i));
  }
  CHECK(slow.take_answers().empty());
}

TEST_CASE("a window or a step that is no time is refused") {
  CHECK_THROWS_AS(TerrainWatch(tests::classifier(2), kCutting, 0.0), std::invalid_argument);
  CHECK_THROWS_AS(TerrainWatch(tests::classifier(2), {.seconds = -1.0}, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
