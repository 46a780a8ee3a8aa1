// SPDX-License-Identifier: Apache-2.0
// Any set of wheels to body twist and back; known vehicles are special cases.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include "finite_difference.hpp"
#include "slipwise/vehicle/ackermann.hpp"
#include "slipwise/vehicle/differential_drive.hpp"
#include "slipwise/vehicle/wheel_layout.hpp"

namespace slipwise {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kUnread = std::numeric_limits<double>::quiet_NaN();
const BodyTwist kMotion{.v = 0.8, .vy = -0.3, .omega = 0.6};

WheelReadings readings_of(const WheelLayout& layout, const WheelTargets& targets) {
  REQUIRE(targets.speed.size() == static_cast<Eigen::Index>(layout.wheels().size()));
  return {.speed = targets.speed, .steering = targets.steering};
}

WheelReadings at_zero(std::size_t wheels) {
  const auto count = static_cast<Eigen::Index>(wheels);
  return {.speed = Eigen::VectorXd::Zero(count), .steering = Eigen::VectorXd::Zero(count)};
}

void check_same(const BodyTwist& found, const BodyTwist& expected) {
  CHECK(found.v == doctest::Approx(expected.v).epsilon(1e-9));
  CHECK(std::abs(found.vy - expected.vy) < 1e-9);
  CHECK(found.omega == doctest::Approx(expected.omega).epsilon(1e-9));
}

WheelLayout skid_steer() {
  std::vector<Wheel> wheels;
  for (const double x : {0.25, -0.25}) {
    for (const double y : {0.3, -0.3}) {
      wheels.push_back({.x = x, .y = y, .radius = 0.15, .roller = 0.0});
    }
  }
  return WheelLayout(wheels);
}

/// Rollers as on all mecanum vehicles: seen from above, their axes on the ground form a diamond.
WheelLayout mecanum() {
  std::vector<Wheel> wheels;
  for (const double x : {0.2, -0.2}) {
    for (const double y : {0.15, -0.15}) {
      wheels.push_back({.x = x, .y = y, .radius = 0.05, .roller = x * y > 0.0 ? -kPi / 4.0 : kPi / 4.0});
    }
  }
  return WheelLayout(wheels);
}

WheelLayout three_omni() {
  std::vector<Wheel> wheels;
  for (const double at : {60.0, 180.0, 300.0}) {
    const double a = at * kPi / 180.0;
    wheels.push_back(
        {.x = 0.13 * std::cos(a), .y = 0.13 * std::sin(a), .radius = 0.06, .angle = a + kPi / 2.0, .roller = 0.0});
  }
  return WheelLayout(wheels);
}

WheelLayout swerve() {
  std::vector<Wheel> wheels;
  for (const double x : {0.4, -0.4}) {
    for (const double y : {0.3, -0.3}) {
      wheels.push_back({.x = x, .y = y, .radius = 0.1, .steered = true});
    }
  }
  return WheelLayout(wheels);
}

/// Rear wheels whose speeds are read, and one steered wheel that is not, in the middle of the front axle.
WheelLayout car(double wheelbase) {
  return WheelLayout({{.x = 0.0, .y = 0.5, .radius = 0.3},
                      {.x = 0.0, .y = -0.5, .radius = 0.3},
                      {.x = wheelbase, .y = 0.0, .radius = 0.3, .steered = true}});
}

TEST_CASE("two wheels on an axle are a differential drive") {
  const DifferentialDrive drive(0.1, 0.5);
  const WheelLayout layout({{.y = 0.25, .radius = 0.1}, {.y = -0.25, .radius = 0.1}});
  const auto found = layout.twist({.speed = Eigen::Vector2d(3.0, 7.0), .steering = Eigen::Vector2d::Zero()});
  check_same(found.twist, drive.twist({.left = 3.0, .right = 7.0}));
  CHECK(layout.tells_sideways());
}

TEST_CASE("wheels that slide across are one drive of sides, and leave sideways motion to slip") {
  const WheelLayout layout = skid_steer();
  CHECK_FALSE(layout.tells_sideways());
  const auto found = layout.twist({.speed = Eigen::Vector4d(3.0, 7.0, 3.0, 7.0), .steering = Eigen::Vector4d::Zero()});
  check_same(found.twist, DifferentialDrive(0.15, 0.6).twist({.left = 3.0, .right = 7.0}));
  CHECK(found.chi2 < 1e-18);
}

TEST_CASE("a car with a steered front wheel is the bicycle model") {
  const WheelLayout layout = car(2.5);
  for (const double steer : {-0.4, 0.0, 0.2}) {
    const BodyTwist truth = Ackermann(2.5).twist(3.0, steer);
    const auto targets = layout.wheels_for(truth, at_zero(3));
    CHECK(targets.steering[2] == doctest::Approx(steer));
    CHECK(targets.across.cwiseAbs().maxCoeff() < 1e-12);
    auto readings = readings_of(layout, targets);
    readings.speed[2] = kUnread;
    check_same(layout.twist(readings).twist, truth);
  }
}

TEST_CASE("omni, mecanum and swerve wheels drive every twist, and tell it again") {
  for (const WheelLayout& layout : {three_omni(), mecanum(), swerve()}) {
    const auto targets = layout.wheels_for(kMotion, at_zero(layout.wheels().size()));
    CHECK(targets.across.cwiseAbs().maxCoeff() < 1e-12);
    const auto found = layout.twist(readings_of(layout, targets));
    check_same(found.twist, kMotion);
    CHECK(found.chi2 < 1e-16);
  }
}

TEST_CASE("mecanum wheels have the textbook's speeds") {
  const auto speed = mecanum().wheels_for(kMotion, at_zero(4)).speed;
  const double arm = 0.2 + 0.15;
  CHECK(speed[0] * 0.05 == doctest::Approx(kMotion.v - kMotion.vy - arm * kMotion.omega));
  CHECK(speed[1] * 0.05 == doctest::Approx(kMotion.v + kMotion.vy + arm * kMotion.omega));
  CHECK(speed[2] * 0.05 == doctest::Approx(kMotion.v + kMotion.vy - arm * kMotion.omega));
  CHECK(speed[3] * 0.05 == doctest::Approx(kMotion.v - kMotion.vy + arm * kMotion.omega));
}

TEST_CASE("a steered wheel turns by no more than a quarter turn, and rolls backwards instead") {
  const auto targets = swerve().wheels_for({.v = -1.0, .vy = 0.1, .omega = 0.0}, at_zero(4));
  CHECK(targets.steering.cwiseAbs().maxCoeff() < kPi / 2.0);
  CHECK(targets.speed.maxCoeff() < 0.0);
  const auto standing = swerve().wheels_for({}, at_zero(4));
  CHECK(standing.steering.isZero(0.0));
}

TEST_CASE("the rear part of an articulated vehicle swings with its hinge") {
  // Front axle at base_link, hinge 1 m behind it, rear axle 2 m behind the hinge.
  const WheelLayout layout({{.y = 0.5, .radius = 0.5},
                            {.y = -0.5, .radius = 0.5},
                            {.x = -3.0, .y = 0.5, .radius = 0.5, .behind_hinge = true},
                            {.x = -3.0, .y = -0.5, .radius = 0.5, .behind_hinge = true}},
                           {}, Hinge{.x = -1.0});
  const double angle = 0.4, rate = 0.1, v = 1.5;
  // Corke and Ridley 2001, with the hinge's angle as the rear is turned to the left.
  const double omega = -(v * std::sin(angle) + 2.0 * rate) / (1.0 * std::cos(angle) + 2.0);
  auto now = at_zero(4);
  now.hinge = angle;
  now.hinge_rate = rate;
  const auto targets = layout.wheels_for({.v = v, .vy = 0.0, .omega = omega}, now);
  CHECK(targets.across.cwiseAbs().maxCoeff() < 1e-12);
  now.speed = targets.speed;
  check_same(layout.twist(now).twist, {.v = v, .vy = 0.0, .omega = omega});
}

/// Four casters with two wheels each, as a PR2 has them: wheels stand beside the joint that turns both.
WheelLayout twin_casters(double behind) {
  std::vector<Wheel> wheels;
  for (const double x : {0.22, -0.22}) {
    for (const double y : {0.22, -0.22}) {
      for (const double beside : {0.05, -0.05}) {
        wheels.push_back({.x = x - behind, .y = y + beside, .radius = 0.075, .steered = true, .pivot = Hinge{x, y}});
      }
    }
  }
  return WheelLayout(wheels);
}

TEST_CASE("an axle that is steered about its middle is the part behind a hinge") {
  const auto axle = [](double y, bool hinged) {
    return Wheel{.x = -1.2,
                 .y = y,
                 .radius = 0.3,
                 .steered = !hinged,
                 .behind_hinge = hinged,
                 .pivot = hinged ? std::optional<Hinge>() : Hinge{-0.9, 0.0}};
  };
  const Wheel left{.y = 0.5, .radius = 0.3}, right{.y = -0.5, .radius = 0.3};
  const WheelLayout steered({left, right, axle(0.5, false), axle(-0.5, false)});
  const WheelLayout hinged({left, right, axle(0.5, true), axle(-0.5, true)}, {}, Hinge{.x = -0.9});
  auto of_hinge = at_zero(4);
  of_hinge.speed << 3.0, 4.0, 3.1, 4.4;
  of_hinge.hinge = 0.3;
  of_hinge.hinge_rate = -0.2;
  WheelReadings of_steering{.speed = of_hinge.speed,
                            .steering = Eigen::Vector4d(0.0, 0.0, 0.3, 0.3),
                            .steering_rate = Eigen::Vector4d(0.0, 0.0, -0.2, -0.2)};
  check_same(steered.twist(of_steering).twist, hinged.twist(of_hinge).twist);
  CHECK(steered.pivoted());
  CHECK_FALSE(hinged.pivoted());
}

TEST_CASE("wheels beside or behind the joint that turns them roll without sliding, and tell the twist") {
  for (const double behind : {0.0, 0.04}) {
    const WheelLayout layout = twin_casters(behind);
    for (const double v : {0.8, -0.8}) {
      const BodyTwist motion{.v = v, .vy = -0.3, .omega = 0.6};
      const auto targets = layout.wheels_for(motion, at_zero(8));
      CHECK(targets.across.cwiseAbs().maxCoeff() < 1e-12);
      for (Eigen::Index i = 0; i < 8; i += 2) {  // both wheels of a caster ask for the same angle
        CHECK(targets.steering[i] == doctest::Approx(targets.steering[i + 1]));
      }
      CHECK(targets.steering.cwiseAbs().maxCoeff() <= kPi / 2.0 + 0.1);
      check_same(layout.twist(readings_of(layout, targets)).twist, motion);
    }
  }
}

TEST_CASE("wheels beside their joint turn against each other while the joint turns, and the twist stays") {
  const WheelLayout layout = twin_casters(0.0);
  auto readings = readings_of(layout, layout.wheels_for(kMotion, at_zero(8)));
  readings.steering_rate = Eigen::VectorXd::Constant(8, 1.5);
  const auto at_rest = readings.speed;
  readings.speed = layout.wheels_for(kMotion, readings).speed;
  CHECK(readings.speed[1] - at_rest[1] == doctest::Approx(1.5 * 0.05 / 0.075));
  CHECK(readings.speed[0] - at_rest[0] == doctest::Approx(-1.5 * 0.05 / 0.075));
  const auto found = layout.twist(readings);
  check_same(found.twist, kMotion);
  CHECK(found.chi2 < 1e-16);
}

TEST_CASE("noise within the stated one is covered by the covariance, and a slipping wheel widens it") {
  const WheelLayout layout = mecanum();
  const auto clean = readings_of(layout, layout.wheels_for(kMotion, at_zero(4)));
  std::mt19937 generator(7);
  std::normal_distribution<double> normal;
  const double along = 0.02 / (0.05 * std::cos(kPi / 4.0));  // [rad/s] of a wheel, 0.02 m/s along the roller
  double squares = 0.0;
  constexpr int kDraws = 2000;
  for (int i = 0; i < kDraws; ++i) {
    auto noisy = clean;
    for (double& speed : noisy.speed) {
      speed += along * normal(generator);
    }
    const auto found = layout.twist(noisy);
    CHECK(found.freedom == 1);
    squares += found.chi2;
  }
  CHECK(squares / kDraws == doctest::Approx(1.0).epsilon(0.15));
  auto slipping = clean;
  slipping.speed[1] += 20.0;
  const double wide = layout.twist(slipping).covariance.trace(), narrow = layout.twist(clean).covariance.trace();
  CHECK(wide > 100.0 * narrow);
}

TEST_CASE("wheels that make no sense are refused") {
  CHECK_THROWS_AS(WheelLayout({}), std::invalid_argument);
  CHECK_THROWS_AS(WheelLayout({{.radius = 0.1, .roller = 0.0}}), std::invalid_argument);
  CHECK_THROWS_AS(WheelLayout({{.y = 0.2}, {.y = -0.2}}), std::invalid_argument);
  CHECK_THROWS_AS(WheelLayout({{.radius = 0.1, .roller = kPi / 2.0}, {.y = 1.0, .radius = 0.1}}),
                  std::invalid_argument);
  CHECK_THROWS_AS(WheelLayout({{.radius = 0.1, .behind_hinge = true}, {.y = 1.0, .radius = 0.1}}),
                  std::invalid_argument);
  CHECK_THROWS_AS(WheelLayout({{.radius = 0.1}, {.y = 1.0, .radius = 0.1}}, {.rolling = 0.0}), std::invalid_argument);
  CHECK_THROWS_AS(WheelLayout({{.radius = 0.1, .pivot = Hinge{}}, {.y = 1.0, .radius = 0.1}}), std::invalid_argument);
  CHECK_THROWS_AS(skid_steer().twist(at_zero(3)), std::invalid_argument);
  auto rates = at_zero(8);
  rates.steering_rate = Eigen::Vector3d::Zero();
  CHECK_THROWS_AS(twin_casters(0.0).twist(rates), std::invalid_argument);
  auto unread = at_zero(4);
  unread.speed.setConstant(kUnread);
  CHECK_THROWS_AS(skid_steer().twist(unread), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
