// SPDX-License-Identifier: Apache-2.0
// A change of terrain is found when residuals agree on it, and not otherwise.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "slipwise/hypotheses/change_detector.hpp"

namespace slipwise {
namespace {

using ByChange = Eigen::Matrix<double, 3, Eigen::Dynamic>;

const ChangeKinds kKinds{{0}, {1}, {0, 1}};
const Eigen::Matrix3d kUnit = Eigen::Matrix3d::Identity();
const Directions kChart = Eigen::Matrix<Eigen::Index, 3, 1>(kAlong, kAcross, kTurn);

/// One change that turns the heading by `size` sigmas, another hand every other segment.
ByChange turns(int segment, double size) {
  ByChange by_change = ByChange::Zero(3, 2);
  by_change(2, 1) = segment % 2 == 0 ? size : -size;
  by_change(0, 0) = size;
  return by_change;
}

/// Six changes, as of the terms linear in V or w: of each direction by what keeps its sign and by what turns with w.
ByChange linear(int segment, double size) {
  ByChange by_change = ByChange::Zero(3, 6);
  for (int direction = 0; direction < 3; ++direction) {
    by_change(direction, 2 * direction) = size;
    by_change(direction, 2 * direction + 1) = segment % 2 == 0 ? size : -size;
  }
  return by_change;
}

const ChangeKinds kAll{{0, 1, 2, 3, 4, 5}};
const ChangeKinds kLinearKinds{{0}, {5}, {0, 5}, {0, 1, 2, 3, 4, 5}};

Eigen::Vector3d noise(std::mt19937_64& random) {
  std::student_t_distribution<double> tail(5.0);
  const double x = tail(random), y = tail(random);
  return Eigen::Vector3d(x, y, tail(random)) * std::sqrt(3.0 / 5.0);
}

TEST_CASE("a change that residuals agree on is found within three segments") {
  std::mt19937_64 random(151);
  ChangeDetector detector{ChangeSettings{}, kKinds};
  for (int i = 0; i < 60; ++i) {
    CHECK_FALSE(detector.see(kChart, noise(random), kUnit, turns(i, 4.0)).alarm);
  }
  bool found = false;
  for (int i = 0; i < 3 && !found; ++i) {
    const ByChange by_change = turns(i, 4.0);
    const ChangeTest test = detector.see(kChart, by_change.col(1) * 1.5 + noise(random), kUnit, by_change);
    found = test.alarm;
    CHECK(test.segments <= i + 2);
  }
  CHECK(found);
}

/// How many of 200 changes of yaw slip by `size` sigmas are found within three segments, after 60 with residuals
/// `scale` as large as their covariance says.
int found_soon(const ChangeKinds& kinds, double size, double scale) {
  int found = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937_64 random(seed);
    ChangeDetector detector{ChangeSettings{}, kinds};
    for (int i = 0; i < 60; ++i) {
      detector.see(kChart, scale * noise(random), kUnit, linear(i, 2.0));
    }
    bool alarm = false;
    for (int i = 0; i < 3 && !alarm; ++i) {
      const Eigen::Vector3d jump = linear(i, size).col(5);
      alarm = detector.see(kChart, jump + scale * noise(random), kUnit, linear(i, 2.0)).alarm;
    }
    found += alarm ? 1 : 0;
  }
  return found;
}

TEST_CASE("nine in ten changes of five sigmas are found within three segments") {
  CHECK(found_soon(kLinearKinds, 5.0, 1.0) >= 180);
}

TEST_CASE("residuals that are always smaller than predicted tell of smaller changes") {
  CHECK(found_soon(kLinearKinds, 2.5, 1.0) < 100);
  CHECK(found_soon(kLinearKinds, 2.5, 0.4) >= 190);
}

TEST_CASE("a change of one kind is found sooner than where all must be fitted") {
  CHECK(found_soon(kLinearKinds, 4.0, 1.0) > found_soon(kAll, 4.0, 1.0) + 20);
}

TEST_CASE("one outlier is no change of terrain, however large") {
  std::mt19937_64 random(152);
  ChangeDetector detector{ChangeSettings{}, kKinds};
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d jump = i == 40 ? Eigen::Vector3d(0.0, 0.0, 100.0) : Eigen::Vector3d::Zero();
    CHECK_FALSE(detector.see(kChart, noise(random) + jump, kUnit, turns(i, 4.0)).alarm);
  }
}

TEST_CASE("residuals that are always alike are nominal on this terrain") {
  std::mt19937_64 random(153);
  ChangeDetector detector{ChangeSettings{}, kKinds};
  double first = 0.0, last = 0.0;
  Eigen::Vector3d slow = Eigen::Vector3d::Zero();
  for (int i = 0; i < 2000; ++i) {
    slow = 0.8 * slow + 0.6 * noise(random);
    const double odds = detector.see(kChart, slow, kUnit, turns(0, 4.0)).log_odds;
    (i < 200 ? first : last) += odds / (i < 200 ? 200.0 : 1800.0);
  }
  CHECK(last < 0.85 * first);
}

TEST_CASE("heavy-tailed residuals raise at most one alarm in a thousand segments") {
  std::mt19937_64 random(154);
  ChangeDetector detector{ChangeSettings{}, kKinds};
  int alarms = 0;
  int longest = 0;
  for (int i = 0; i < 20000; ++i) {
    const ChangeTest test = detector.see(kChart, noise(random), kUnit, turns(i, 4.0));
    alarms += test.alarm ? 1 : 0;
    longest = std::max(longest, test.segments);
  }
  CHECK(alarms <= 20);
  CHECK(longest == ChangeSettings{}.longest);  // and none is remembered for longer
}

TEST_CASE("a small change is suspected before it is an alarm, and a restart leaves out what was before") {
  std::mt19937_64 random(157);
  ChangeDetector detector{ChangeSettings{}, kKinds};
  for (int i = 0; i < 60; ++i) {
    detector.see(kChart, noise(random), kUnit, turns(i, 2.0));
  }
  int suspected = -1;
  int found = -1;
  for (int i = 0; i < 20; ++i) {
    const ChangeTest test = detector.see(kChart, turns(i, 2.0).col(1) * 1.2 + noise(random), kUnit, turns(i, 2.0));
    suspected = test.suspicion && suspected < 0 ? i : suspected;
    found = test.alarm && found < 0 ? i : found;
    CHECK((!test.alarm || test.suspicion));
  }
  CHECK(suspected >= 0);
  CHECK((found < 0 || suspected <= found));
  detector.restart();
  CHECK(detector.see(kChart, noise(random), kUnit, turns(0, 2.0)).segments == 0);
}

TEST_CASE("a parked robot shows no change") {
  std::mt19937_64 random(155);
  ChangeDetector detector{ChangeSettings{}, kKinds};
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d pose_jumps(3.0, -4.0, 2.0);
    CHECK(detector.see(kChart, pose_jumps, kUnit, ByChange::Zero(3, 2)).log_odds == 0.0);
  }
}

TEST_CASE("a robot that was parked for long does not take its own driving for a change") {
  std::mt19937_64 random(156);
  ChangeDetector detector{ChangeSettings{}, kKinds};
  for (int i = 0; i < 600; ++i) {
    const bool parked = i < 30 || (i >= 100 && i < 500);
    const double moving = parked ? 0.0 : 1.0;
    CHECK_FALSE(detector.see(kChart, (0.01 + moving) * noise(random), kUnit, turns(i, 4.0 * moving)).alarm);
  }
}

TEST_CASE("a model without parameters has nothing that could change") {
  ChangeDetector detector{ChangeSettings{}, {}};
  CHECK_FALSE(detector.see(kChart, Eigen::Vector3d::Ones(), kUnit, ByChange(3, 0)).alarm);
}

TEST_CASE("a kind of change without any column is refused") {
  CHECK_THROWS_AS(ChangeDetector(ChangeSettings{}, {{0}, {}}), std::invalid_argument);
}

TEST_CASE("a test over no segment is refused") {
  ChangeSettings settings;
  settings.longest = settings.shortest - 1;
  CHECK_THROWS_AS(ChangeDetector(settings, kKinds), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
