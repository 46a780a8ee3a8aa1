// SPDX-License-Identifier: Apache-2.0
// A simulated car with a dead zone: its curves are found from what it was told and how it moved.
// So holds lag_variance.
#include "slipwise/identify/car_curve_filter.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace slipwise {
namespace {

constexpr double kStep = 0.05;  // [s] between commands
constexpr double kTwist = 0.2;  // [s] between measured twists

CarCurves true_car() {
  return {.speed = {.at = {-1.0, 0.0, 0.2, 0.5, 1.0}, .value = {-1.0, 0.0, 0.0, 2.0, 3.0}, .std = {}},
          .curvature = {.at = {-1.0, 0.0, 1.0}, .value = {-2.1, 0.1, 1.5}, .std = {}},
          .lag = 0.4,
          .steering_lag = 0.1,
          .cornering_drag = 0.15,
          .understeer = 0.08};
}

struct CarDrive {
  InputHistory commands;
  std::vector<BodyTwist> twists;  ///< means over each fifth of a second
};

/// Throttles of [0, 0.6] and any steering, each held for a second and a half, and reaches it after its delay.
CarDrive random_drive(const CarCurves& car, double seconds, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> throttle(0.0, 0.6), steering(-1.0, 1.0);
  std::normal_distribution<double> normal(0.0, noise);
  std::vector<double> t;
  std::vector<BodyTwist> command;
  CarDrive drive;
  CarState state;
  BodyTwist now{}, sum{};
  const auto steps = static_cast<int>(std::lround(seconds / kStep));
  for (int i = 0; i < steps; ++i) {
    if (i % 30 == 0) {
      now = {.v = throttle(random), .vy = 0.0, .omega = steering(random)};
    }
    t.push_back(i * kStep);
    command.push_back(now);
    constexpr int kFine = 10;
    for (int k = 0; k < kFine; ++k) {
      const double given = std::floor(i + (static_cast<double>(k) / kFine) - (car.delay / kStep) + 1e-9);
      state = advanced(car, state, given < 0.0 ? BodyTwist{} : command[static_cast<std::size_t>(given)], kStep / kFine);
      sum.v += car_twist(car, state).v / kFine;
      sum.omega += car_twist(car, state).omega / kFine;
    }
    if (i % 4 == 3) {
      drive.twists.push_back({.v = sum.v / 4.0 + normal(random), .vy = 0.0, .omega = sum.omega / 4.0 + normal(random)});
      sum = {};
    }
  }
  drive.commands = {std::move(t), std::move(command)};
  return drive;
}

CarCurveFilter learned(const CarDrive& drive, std::size_t count) {
  CarCurveFilter filter({.top_speed = 4.0, .curvature = 1.5});
  filter.start_run(0.0);
  for (std::size_t k = 0; k < std::min(count, drive.twists.size()); ++k) {
    filter.follow(drive.commands, static_cast<double>(k + 1) * kTwist, &drive.twists[k]);
  }
  return filter;
}

TEST_CASE("a curve is sure where the car drove and as its prior where it did not; a lag is as its spacing") {
  const CarCurves found = learned(random_drive(true_car(), 240.0, 0.02, 7), 10000).curves();
  REQUIRE(found.spread != nullptr);
  const Eigen::VectorXd std = found.spread->covariance.diagonal().cwiseSqrt();
  const Eigen::Index speeds = std::ssize(found.speed.at), last = speeds - 1, single = std.size() - 5;
  CHECK(std[last] > 0.5 * found.spread->prior_std[last]);
  CHECK(std[last] == doctest::Approx(found.speed.std.back()));
  for (Eigen::Index k = 0; k < speeds; ++k) {
    const double throttle = found.speed.at[static_cast<std::size_t>(k)];
    if (throttle > 0.0 && throttle < 0.55) {
      CHECK(std[k] < 0.1);
    }
  }
  CHECK(std[single] > 0.01);
  CHECK(std[single] < 0.2);
  CHECK(std::abs(found.lag - 0.4) < 3.0 * std[single]);
  CHECK(std::abs(found.cornering_drag - 0.15) < 4.0 * std[single + 2]);
  CHECK(std::abs(found.understeer - 0.08) < 4.0 * std[single + 3]);
}

TEST_CASE("lags and a delay of throttle and steering are found apart, and known as well as they say") {
  for (const auto& [lag, steering_lag, delay] :
       {std::array{0.4, 0.1, 0.1}, std::array{0.27, 0.06, 0.0}, std::array{0.42, 0.14, 0.07},
        std::array{0.66, 0.09, 0.12}, std::array{0.9, 0.18, 0.2}}) {
    CarCurves car = true_car();
    car.lag = lag;
    car.steering_lag = steering_lag;
    car.delay = delay;
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const CarCurves found = learned(random_drive(car, 240.0, 0.02, seed), 10000).curves();
      const Eigen::VectorXd std = found.spread->covariance.diagonal().cwiseSqrt().tail<5>();
      CHECK(std::abs(found.lag - lag) < 3.0 * std[0]);
      CHECK(std::abs(found.steering_lag - steering_lag) < 3.0 * std[1]);
      CHECK(std::abs(found.delay - delay) < 3.0 * std[4]);
      CHECK(std::abs(found.lag + found.delay - lag - delay) < 0.01 + 0.05 * (lag + delay));
    }
  }
}

TEST_CASE("the curves of a car with a dead zone are found where it drove") {
  const CarCurves car = true_car();
  const CarCurves found = learned(random_drive(car, 240.0, 0.02, 7), 10000).curves();
  for (const double throttle : {0.1, 0.2, 0.3, 0.4, 0.5}) {
    CHECK(std::abs(found.speed(throttle) - car.speed(throttle)) < 0.1);
  }
  for (const double steering : {-0.8, -0.4, 0.0, 0.4, 0.8}) {
    CHECK(std::abs(found.curvature(steering) - car.curvature(steering)) < 0.12);
  }
  CHECK(found.lag == doctest::Approx(0.4));
  CHECK(found.steering_lag == doctest::Approx(0.1));
  CHECK(std::abs(found.cornering_drag - 0.15) < 0.08);
  CHECK(std::abs(found.understeer - 0.08) < 0.04);
}

TEST_CASE("the true curve lies within three of its standard deviations") {
  const CarCurves car = true_car();
  int inside = 0, all = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const CarCurves found = learned(random_drive(car, 120.0, 0.05, seed), 10000).curves();
    for (std::size_t k = 0; k < found.speed.at.size(); ++k) {
      const double throttle = found.speed.at[k];
      if (throttle >= 0.0 && throttle <= 0.5) {
        ++all;
        inside += std::abs(found.speed.value[k] - car.speed(throttle)) <= 3.0 * found.speed.std[k] + 1e-9 ? 1 : 0;
      }
    }
  }
  CHECK(inside >= all - all / 20);
}

TEST_CASE("a curve never falls, and stays near what was taken before where nothing was driven") {
  const CarCurves found = learned(random_drive(true_car(), 60.0, 0.1, 3), 10000).curves();
  for (const KnotCurve* curve : {&found.speed, &found.curvature}) {
    CHECK(std::ranges::is_sorted(curve->value));
  }
  CHECK(found.speed(-1.0) == doctest::Approx(-4.0));
  CHECK(found.speed.std.front() > 1.0);
}

TEST_CASE("nothing is learned before twists come") {
  const CarCurveFilter filter({.top_speed = 3.0, .curvature = 2.0});
  CHECK(filter.curves().speed(0.5) == doctest::Approx(1.5));
  CHECK(filter.curves().curvature(-0.5) == doctest::Approx(-1.0));
  CHECK(filter.straight().speed(1.0) == doctest::Approx(3.0));
}

TEST_CASE("the kinematic bicycle takes the gains that fit best so far") {
  CarCurves car = true_car();
  car.speed = {.at = {-1.0, 1.0}, .value = {-2.0, 2.0}, .std = {}};
  car.curvature = {.at = {-1.0, 1.0}, .value = {-1.2, 1.2}, .std = {}};
  car.lag = car.steering_lag = car.cornering_drag = car.understeer = 0.0;
  const CarCurves found = learned(random_drive(car, 120.0, 0.01, 5), 10000).straight();
  CHECK(found.speed(1.0) == doctest::Approx(2.0).epsilon(0.03));
  CHECK(found.curvature(1.0) == doctest::Approx(1.2).epsilon(0.03));
}

TEST_CASE("an outlier moves the curves little") {
  CarDrive drive = random_drive(true_car(), 120.0, 0.02, 9);
  const CarCurves before = learned(drive, 10000).curves();
  drive.twists[300].v = 60.0;
  drive.twists[300].omega = -40.0;
  const CarCurves after = learned(drive, 10000).curves();
  for (const double throttle : {0.1, 0.3, 0.5}) {
    CHECK(std::abs(before.speed(throttle) - after.speed(throttle)) < 0.1);
  }
}

TEST_CASE("a steady sideways slip is followed, with a lag of its own") {
  CarDrive drive = random_drive(true_car(), 40.0, 0.01, 2);
  for (BodyTwist& twist : drive.twists) {
    twist.vy = -0.3;
  }
  const KnownMotion motion = learned(drive, 10000).motion();
  CHECK(motion.sideways == doctest::Approx(-0.3));
  CHECK(motion.sideways_lag == doctest::Approx(1.5));
}

TEST_CASE("after the last twist that was learned, what the car does follows one of a shorter time by its weight") {
  CarDrive drive = random_drive(true_car(), 40.0, 0.01, 2);
  for (BodyTwist& twist : drive.twists) {
    twist.vy = -0.3;
  }
  const CarCurveFilter filter = learned(drive, 10000);
  const double t = filter.until() + 0.1, left = -0.3 * std::exp(-0.1 / 1.5);
  const BodyTwist twist{.v = filter.motion().speed + 0.4, .vy = 0.1, .omega = 0.0};
  const KnownMotion none = filter.motion(drive.commands, t, twist, 0.0);
  const KnownMotion half = filter.motion(drive.commands, t, twist, 0.5);
  CHECK(none.t == t);
  CHECK(none.sideways == doctest::Approx(left));
  CHECK(half.sideways == doctest::Approx(0.5 * (left + 0.1)));
  CHECK(half.speed > none.speed);
  CHECK(filter.motion().sideways == doctest::Approx(-0.3));
  const KnownMotion jumped = filter.motion(drive.commands, t, {.v = 60.0, .vy = 0.0, .omega = -40.0}, 1.0);
  CHECK(jumped.speed == none.speed);
}

}  // namespace
}  // namespace slipwise
