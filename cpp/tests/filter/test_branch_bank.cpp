// SPDX-License-Identifier: Apache-2.0
// Slip that jumps is followed within seconds; where it stays, branches change nothing that matters.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "simulated_drive.hpp"
#include "slipwise/filter/causal_filter.hpp"

namespace slipwise {
namespace {

const ReferenceSpeeds kBankSpeeds{.v = 1.5, .omega = 0.8};
const MotionNoise kBankNoise{.psd_time = {1e-4, 1e-4, 1e-4}, .pose_std_xy = 0.01, .pose_std_yaw = 0.004};
constexpr Eigen::Index kYaw = 1;  // place of the yaw slip that goes with omega

CausalFilter filter_of(const MotionModel& model, bool branches) {
  CausalFilterSettings settings;
  settings.noise.shape = kBankNoise;
  settings.branches.follow = branches;
  return {model, settings};
}

void learn(CausalFilter& filter, const tests::SimulatedDrive& drive) {
  for (const Segment& segment : drive.segments) {
    filter.learn(drive.inputs, segment, kBankSpeeds);
  }
}

tests::SimulatedDrive driven(const MotionModel& model, double yaw_slip, std::uint64_t seed, std::size_t windows) {
  return tests::simulate_drive(model, Eigen::Vector2d(-0.05, yaw_slip),
                               {.seed = seed, .windows = windows, .window = 1.0, .noise = kBankNoise});
}

TEST_CASE("a jump of yaw slip is followed within ten segments, and counts as another terrain") {
  const MotionModel model(named_basis("edd-2"), {});
  for (const double jumped : {-0.15, -0.23, -0.45}) {
    CAPTURE(jumped);
    CausalFilter branches = filter_of(model, true);
    CausalFilter plain = filter_of(model, false);
    const auto before = driven(model, -0.3, 91, 200);
    learn(branches, before);
    learn(plain, before);
    CHECK(branches.estimate().mean[kYaw] == doctest::Approx(-0.3).epsilon(0.05));
    const auto after = driven(model, jumped, 92, 10);
    learn(plain, after);
    int changes = 0;
    for (const Segment& segment : after.segments) {
      branches.learn(after.inputs, segment, kBankSpeeds);
      changes += branches.branches().change().alarm ? 1 : 0;
    }
    CHECK(std::abs(branches.estimate().mean[kYaw] - jumped) < 0.03);
    CHECK(std::abs(plain.estimate().mean[kYaw] - jumped) > 0.06);
    const auto later = driven(model, jumped, 93, 30);
    for (const Segment& segment : later.segments) {
      branches.learn(later.inputs, segment, kBankSpeeds);
      changes += branches.branches().change().alarm ? 1 : 0;
    }
    CHECK(changes == 1);
  }
}

TEST_CASE("a change says nothing of slip that lasts: the second is followed as soon as the first") {
  const MotionModel model(named_basis("edd-2"), {});
  for (std::uint64_t seed = 110; seed < 116; ++seed) {
    CAPTURE(seed);
    CausalFilter filter = filter_of(model, true);
    learn(filter, driven(model, -0.2, seed, 36));
    for (const double jumped : {-0.4, -0.1, -0.5}) {
      CAPTURE(jumped);
      learn(filter, driven(model, jumped, seed + 10, 8));
      CHECK(std::abs(filter.estimate().mean[kYaw] - jumped) < 0.03);
      learn(filter, driven(model, jumped, seed + 20, 28));
    }
  }
}

TEST_CASE("where slip stays, it is known as well as if it never jumped") {
  const MotionModel model(named_basis("edd-2"), {});
  double followed = 0.0, fixed = 0.0;
  for (std::uint64_t seed = 95; seed < 105; ++seed) {
    CausalFilter branches = filter_of(model, true);
    CausalFilter plain = filter_of(model, false);
    const auto drive = driven(model, -0.3, seed, 60);
    for (const Segment& segment : drive.segments) {
      branches.learn(drive.inputs, segment, kBankSpeeds);
      plain.learn(drive.inputs, segment, kBankSpeeds);
      CHECK_FALSE(branches.branches().change().alarm);
      followed += std::abs(branches.estimate().mean[kYaw] + 0.3);
      fixed += std::abs(plain.estimate().mean[kYaw] + 0.3);
    }
  }
  CHECK(followed < 1.05 * fixed);
}

TEST_CASE("a change that is expected makes slip less sure, once until something is learned, and is followed sooner") {
  const MotionModel model(named_basis("edd-2"), {});
  CausalFilter told = filter_of(model, true);
  learn(told, driven(model, -0.3, 107, 60));
  CausalFilter alone = told;
  const double before = told.reported().covariance(kYaw, kYaw);
  told.take(ChangeExpected{});
  const Eigen::MatrixXd once = told.reported().covariance;
  CHECK(once(kYaw, kYaw) > 4.0 * before);
  told.take(ChangeExpected{});
  CHECK(told.reported().covariance == once);
  const auto after = driven(model, -0.4, 108, 2);
  learn(told, after);
  learn(alone, after);
  CHECK(std::abs(told.estimate().mean[kYaw] + 0.4) < std::abs(alone.estimate().mean[kYaw] + 0.4));
}

TEST_CASE("a basis without slip that every terrain shows has no branches, and learns as without") {
  for (const Basis& basis : {Basis("none", {}, {}, {}), Basis("odd", std::vector<std::string>{"V*V"}, {}, {})}) {
    const MotionModel model(basis, {});
    CausalFilter branches = filter_of(model, true);
    CausalFilter plain = filter_of(model, false);
    const auto drive = driven(MotionModel(named_basis("edd-2"), {}), -0.3, 106, 5);
    learn(branches, drive);
    learn(plain, drive);
    CHECK(branches.estimate().mean == plain.estimate().mean);
    CHECK(branches.estimate().covariance == plain.estimate().covariance);
  }
}

}  // namespace
}  // namespace slipwise
