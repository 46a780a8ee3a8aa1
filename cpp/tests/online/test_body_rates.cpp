// SPDX-License-Identifier: Apache-2.0
#include "slipwise/online/body_rates.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <random>

#include "slipwise/lie/se2.hpp"

using namespace slipwise;

namespace {

struct Drive {
  std::function<BodyTwist(double)> twist;
  double seconds;
  double interval = 0.05;
  Pose2 sensor = {};
  double noise = 0.0;  ///< [m], and half of it [rad]
};

/// What poses of a robot that moves by `twist` show.
MeasuredRates rates_of(const Drive& drive) {
  BodyRates rates(drive.sensor);
  Pose2 base{0.0, 0.0, 0.0};
  double yaw = 0.0;
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.0, drive.noise > 0.0 ? drive.noise : 1.0);
  const auto noise = [&](double share) { return drive.noise > 0.0 ? share * normal(random) : 0.0; };
  for (int i = 0; i * drive.interval <= drive.seconds; ++i) {
    const double t = i * drive.interval;
    const Pose2 at = compose(base, drive.sensor);
    rates.push({.t = t, .x = at.x + noise(1.0), .y = at.y + noise(1.0), .yaw = yaw + drive.sensor.theta + noise(0.5)});
    const BodyTwist twist = drive.twist(t);
    base = compose(base, exp(Eigen::Vector3d(twist.v, 0.0, twist.omega) * drive.interval));
    yaw += twist.omega * drive.interval;
  }
  return rates.found();
}

}  // namespace

TEST_CASE("a steady drive has its rates and hardly an acceleration, wherever the sensor sits") {
  const MeasuredRates found = rates_of({.twist = [](double) { return BodyTwist{.v = 0.8, .omega = -0.4}; },
                                        .seconds = 20.0,
                                        .sensor = {0.3, -0.2, 0.7}});
  CHECK(found.speed[1] == doctest::Approx(0.8).epsilon(1e-6));
  CHECK(found.speed[0] == 0.0);
  CHECK(found.yaw_rate[0] == doctest::Approx(0.4).epsilon(1e-6));
  CHECK(found.yaw_rate[1] == 0.0);
  CHECK(found.acceleration[0] < 1e-6);
  CHECK(found.seconds == doctest::Approx(20.0));
}

TEST_CASE("rates of short bursts count although the robot stands or creeps most of the time") {
  const auto twist = [](double t) {
    const bool burst = static_cast<int>(t) % 10 == 0;
    return BodyTwist{.v = burst ? -1.0 : 0.02, .omega = burst ? 0.6 : 0.0};
  };
  const MeasuredRates found = rates_of({.twist = twist, .seconds = 100.0});
  CHECK(found.speed[0] == doctest::Approx(1.0).epsilon(0.03));
  CHECK(found.yaw_rate[1] == doctest::Approx(0.6).epsilon(0.03));
}

TEST_CASE("ramps away from standstill and towards it are told apart") {
  const auto twist = [](double t) {
    const double phase = t - 10.0 * static_cast<int>(t / 10.0);  // 4 s at 0.25 m/s^2, 2 s back at 0.5 m/s^2
    return BodyTwist{.v = phase < 4.0 ? 0.25 * phase : std::max(0.0, 1.0 - 0.5 * (phase - 4.0)), .omega = 0.0};
  };
  const MeasuredRates found = rates_of({.twist = twist, .seconds = 100.0});
  CHECK(found.acceleration[0] == doctest::Approx(0.25).epsilon(0.06));
  CHECK(found.acceleration[1] == doctest::Approx(0.5).epsilon(0.06));
}

TEST_CASE("poses that are too rare show nothing") {
  const MeasuredRates found =
      rates_of({.twist = [](double) { return BodyTwist{.v = 1.0}; }, .seconds = 40.0, .interval = 2.0});
  CHECK(found.seconds == 0.0);
  CHECK(found.speed[1] == 0.0);
}

TEST_CASE("noise of poses makes the greatest rates no larger, and hides them no more than it must") {
  const auto twist = [](double t) {
    const double phase = t - 10.0 * static_cast<int>(t / 10.0);
    const double v = phase < 2.0 ? 0.5 * phase : std::max(0.0, 1.0 - 0.5 * std::max(phase - 6.0, 0.0));
    return BodyTwist{.v = v, .omega = 0.6 * v};
  };
  for (const double interval : {0.05, 0.1, 0.25}) {
    CAPTURE(interval);
    const MeasuredRates found = rates_of({.twist = twist, .seconds = 300.0, .interval = interval, .noise = 0.02});
    CHECK(found.speed[1] == doctest::Approx(1.0).epsilon(0.05));
    CHECK(found.yaw_rate[1] == doctest::Approx(0.6).epsilon(0.05));
    CHECK(found.acceleration[0] < 0.57);
    CHECK(found.acceleration[0] > 0.35);
  }
}
