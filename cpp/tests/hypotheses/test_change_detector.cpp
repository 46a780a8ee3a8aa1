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
    CHECK_FALSE(detector.see(noise(random), kUnit, turns(i, 4.0)).alarm);
  }
  bool found = false;
  for (int i = 0; i < 3 && !found; ++i) {
    const ByChange by_change = turns(i, 4.0);
    const ChangeTest test = detector.see(by_change.col(1) * 1.5 + noise(random), kUnit, by_change);
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
      detector.see(scale * noise(random), kUnit, linear(i, 2.0));
    }
    bool alarm = false;
    for (int i = 0; i < 3 && !alarm; ++i) {
      const Eigen::Vector3d jump = linear(i, size).col(5);
      alarm = detector.see(jump + scale * noise(random), kUnit, linear(i, 2.0)).alarm;
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
    CHECK_FALSE(detector.see(noise(random) + jump, kUnit, turns(i, 4.0)).alarm);
  }
}

/// Suspicions in 4000 segments whose residuals follow each other as by `keep`, from the 200th on.
int suspicions(double keep, const Eigen::Matrix3d& covariance) {
  std::mt19937_64 random(153);
  ChangeDetector detector{ChangeSettings{}, kKinds};
  int found = 0;
  Eigen::Vector3d slow = Eigen::Vector3d::Zero();
  for (int i = 0; i < 4000; ++i) {
    slow = keep * slow + std::sqrt(1.0 - keep * keep) * noise(random);
    const bool suspicion = detector.see(slow, covariance, turns(0, 1.0)).suspicion;
    found += i >= 200 && suspicion ? 1 : 0;
  }
  return found;
}

TEST_CASE("residuals that are always alike are nominal on this terrain") {
  CHECK(suspicions(0.0, kUnit) <= 80);
  CHECK(suspicions(0.8, kUnit) <= 160);
}

TEST_CASE("a change too small for eight segments is found over more") {
  int found = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937_64 random(1000 + seed);
    ChangeDetector detector{ChangeSettings{}, kKinds};
    for (int i = 0; i < 60; ++i) {
      detector.see(noise(random), kUnit, turns(i, 1.0));
    }
    int segments = 0;
    for (int i = 0; i < 40 && segments == 0; ++i) {
      const ChangeTest test = detector.see(turns(i, 1.0).col(1) + noise(random), kUnit, turns(i, 1.0));
      segments = test.alarm ? i + 1 : 0;
    }
    found += segments > 8 ? 1 : 0;
  }
  CHECK(found >= 40);
}

TEST_CASE("a run that does not follow the last is not held against its end") {
  std::mt19937_64 random(158);
  ChangeDetector detector{ChangeSettings{}, kKinds};
  Eigen::Vector3d slow = Eigen::Vector3d::Zero();
  for (int i = 0; i < 400; ++i) {
    slow = 0.9 * slow + 0.4 * noise(random);
    detector.see(slow, kUnit, turns(0, 2.0));
  }
  ChangeDetector other = detector;
  other.start_run();
  detector.restart();
  other.restart();
  const ByChange by_change = turns(0, 2.0);
  CHECK(detector.see(slow, kUnit, by_change).log_odds != other.see(slow, kUnit, by_change).log_odds);
}

TEST_CASE("heavy-tailed residuals raise at most one alarm in a thousand segments") {
  std::mt19937_64 random(154);
  ChangeDetector detector{ChangeSettings{}, kKinds};
  int alarms = 0;
  int longest = 0;
  for (int i = 0; i < 20000; ++i) {
    const ChangeTest test = detector.see(noise(random), kUnit, turns(i, 4.0));
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
    detector.see(noise(random), kUnit, turns(i, 2.0));
  }
  int suspected = -1;
  int found = -1;
  for (int i = 0; i < 20; ++i) {
    const ChangeTest test = detector.see(turns(i, 2.0).col(1) * 1.2 + noise(random), kUnit, turns(i, 2.0));
    suspected = test.suspicion && suspected < 0 ? i : suspected;
    found = test.alarm && found < 0 ? i : found;
    CHECK((!test.alarm || test.suspicion));
  }
  CHECK(suspected >= 0);
  CHECK((found < 0 || suspected <= found));
  detector.restart();
  CHECK(detector.see(noise(random), kUnit, turns(0, 2.0)).segments <= 1);
}

TEST_CASE("a parked robot shows no change") {
  std::mt19937_64 random(155);
  ChangeDetector detector{ChangeSettings{}, kKinds};
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d pose_jumps(3.0, -4.0, 2.0);
    const ChangeTest test = detector.see(pose_jumps, kUnit, ByChange::Zero(3, 2));
    CHECK(test.log_odds <= 1e-12);
    CHECK_FALSE(test.suspicion);
  }
}

TEST_CASE("a robot that was parked for long does not take its own driving for a change") {
  std::mt19937_64 random(156);
  ChangeDetector detector{ChangeSettings{}, kKinds};
  for (int i = 0; i < 600; ++i) {
    const bool parked = i < 30 || (i >= 100 && i < 500);
    const double moving = parked ? 0.0 : 1.0;
    CHECK_FALSE(detector.see((0.01 + moving) * noise(random), kUnit, turns(i, 4.0 * moving)).alarm);
  }
}

TEST_CASE("a model without parameters has nothing that could change") {
  ChangeDetector detector{ChangeSettings{}, {}};
  CHECK_FALSE(detector.see(Eigen::Vector3d::Ones(), kUnit, ByChange(3, 0)).alarm);
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
