// SPDX-License-Identifier: Apache-2.0
// Segments join where they can, end at poses, and say why they are none.
#include <doctest/doctest.h>

#include <vector>

#include "slipwise/online/segment_cutter.hpp"

namespace slipwise {
namespace {

struct Setting {
  InputBuffer inputs{0.5};
  PoseTimer timer;
  SegmentCutter cutter{1.0, SegmentRules{}, true};
  std::vector<SegmentCut> cuts;

  void drive(double from, double to, double v) {
    for (double t = from; t < to; t += 0.1) {
      inputs.push({t, {v, 0.0, 0.0}});
    }
  }
  void poses(int from, int to, long frame = 0) {
    for (int i = from; i < to; ++i) {
      const double t = 0.1 * i;
      if (const auto timed = timer.push({.t = t, .x = t, .y = 0.0, .yaw = 0.0, .frame = frame}, 2.5)) {
        for (SegmentCut& cut : cutter.push(*timed, inputs)) {
          cuts.push_back(cut);
        }
      }
    }
  }
};

}  // namespace

TEST_CASE("segments start where the last ended and are of the length asked for") {
  Setting s;
  s.drive(0.0, 10.0, 1.0);
  s.poses(0, 100);
  REQUIRE(s.cuts.size() == 9);
  for (std::size_t i = 0; i < s.cuts.size(); ++i) {
    CHECK(!s.cuts[i].rejected);
    CHECK(s.cuts[i].second.t - s.cuts[i].first.t == doctest::Approx(1.0));
    CHECK(s.cuts[i].measured().x == doctest::Approx(1.0));
    CHECK((i == 0 || s.cuts[i].first.t == s.cuts[i - 1].second.t));
  }
}

TEST_CASE("a parked robot teaches nothing, and says so") {
  Setting s;
  s.drive(0.0, 10.0, 0.0);
  s.poses(0, 100);
  REQUIRE(!s.cuts.empty());
  for (const SegmentCut& cut : s.cuts) {
    CHECK(cut.rejected == Reason::StandingStill);
  }
}

TEST_CASE("a robot that never drives faster than 1 cm/s teaches; one that drove 1 m/s stands at that speed") {
  for (const double before : {0.0, 1.0}) {
    Setting s;
    s.drive(0.0, 5.0, before);
    s.drive(5.05, 20.0, 0.01);
    s.poses(0, 200);
    REQUIRE(!s.cuts.empty());
    CHECK(s.cuts.back().rejected.has_value() == (before == 1.0));
  }
}

TEST_CASE("wheels whose noise goes to and fro stand, also before the robot ever drove") {
  Setting s;
  for (int i = 0; i < 400; ++i) {
    s.inputs.push({0.05 * i, {i % 3 == 0 ? 0.012 : -0.006, 0.0, 0.0}});
  }
  s.poses(0, 190);
  REQUIRE(!s.cuts.empty());
  for (const SegmentCut& cut : s.cuts) {
    CHECK(cut.rejected == Reason::StandingStill);
  }
}

TEST_CASE("no segment spans unknown inputs; the next begins once they are known again") {
  Setting s;
  s.drive(0.0, 3.0, 1.0);
  s.drive(6.05, 10.0, 1.0);
  s.poses(0, 100);
  bool unknown = false;
  for (const SegmentCut& cut : s.cuts) {
    unknown = unknown || cut.rejected == Reason::UnknownInput;
    CHECK((cut.rejected || cut.second.t <= 3.5 || cut.first.t >= 6.0));
  }
  CHECK(unknown);
  CHECK(!s.cuts.back().rejected);
}

TEST_CASE("poses of two frames make no segment; a short frame is one segment") {
  Setting s;
  s.drive(0.0, 10.0, 1.0);
  s.poses(0, 6, 0);
  s.poses(6, 30, 1);
  REQUIRE(!s.cuts.empty());
  CHECK(s.cuts.front().first.t == 0.0);
  CHECK(s.cuts.front().second.t == doctest::Approx(0.5));
  for (const SegmentCut& cut : s.cuts) {
    CHECK(cut.first.frame == cut.second.frame);
  }
}

TEST_CASE("segments between positions are as long as positions need, and share none") {
  struct Case {
    double speed;
    double noise;
    std::size_t positions;
  };
  for (const Case& each : {Case{0.5, 1e-3, 50}, Case{5.0, 0.01, 50}, Case{30.0, 0.01, 25}, Case{30.0, 0.5, 50}}) {
    CAPTURE(each.speed);
    CAPTURE(each.noise);
    InputBuffer inputs{0.5};
    PoseTimer timer;
    SegmentCutter cutter(1.0, SegmentRules{.of_positions = 5.0}, true);
    for (int i = 0; i < 50; ++i) {
      cutter.see_noise(each.noise);
    }
    std::vector<SegmentCut> cuts;
    for (int i = 0; i < 160; ++i) {
      const double t = 0.1 * i;
      inputs.push({t, {each.speed, 0.0, 0.0}});
      const auto timed = timer.push({.t = t, .x = each.speed * t, .y = 0.0, .yaw = 0.0, .position = true}, 2.5);
      REQUIRE(timed);
      for (SegmentCut& cut : cutter.push(*timed, inputs)) {
        cuts.push_back(cut);
      }
    }
    REQUIRE(cuts.size() == 150 / each.positions);
    CHECK(cuts[0].positions.size() == each.positions);
    CHECK(cuts[0].positions.front().t == 0.0);
    CHECK(cuts[1].positions.front().t > cuts[0].positions.back().t);
    CHECK(cuts[1].first.t == cuts[0].second.t);
  }
}

}  // namespace slipwise
