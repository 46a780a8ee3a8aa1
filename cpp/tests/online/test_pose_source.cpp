// SPDX-License-Identifier: Apache-2.0
// Poses of a source that come out of order.
#include "slipwise/online/pose_source.hpp"

#include <doctest/doctest.h>

#include <limits>

namespace slipwise {
namespace {

MeasuredPose at(double t) { return {.t = t, .x = t, .y = 0.0, .yaw = 0.0, .source = 1}; }

TEST_CASE("poses wait in the order of their stamps, however they come") {
  PoseSource source;
  for (const double t : {2.0, 1.0, 3.0, 1.5}) {
    CHECK_FALSE(source.take(at(t)));
  }
  CHECK(source.take(at(3.0)) == Reason::DuplicateStamp);
  CHECK(source.take(at(std::numeric_limits<double>::quiet_NaN())) == Reason::NotFinite);
  REQUIRE(source.waiting.size() == 4);
  CHECK(source.waiting[0].t == 1.0);
  CHECK(source.waiting[1].t == 1.5);
  CHECK(source.waiting[3].t == 3.0);
  source.used = 2.5;
  CHECK(source.take(at(2.2)) == Reason::TooLate);
  source.restart();
  CHECK(source.waiting.empty());
  CHECK_FALSE(source.take(at(0.5)));
}

TEST_CASE("a pose and a position alone are not compared") {
  PoseSource source;
  CHECK_FALSE(source.take(at(1.0)));
  MeasuredPose position = at(2.0);
  position.position = true;
  CHECK_FALSE(source.take(position));
  CHECK(source.waiting[0].frame != source.waiting[1].frame);
}

}  // namespace
}  // namespace slipwise
