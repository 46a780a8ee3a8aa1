// SPDX-License-Identifier: Apache-2.0
// Rollouts of a car do what its curves do under a held command, from where it is.
#include "slipwise/rollout/car_batch.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace slipwise {
namespace {

constexpr double kCarPeriod = 0.1;
constexpr std::size_t kCarPeriods = 30;

CarCurves car() {
  return {.speed = {.at = {-1.0, 0.0, 0.2, 1.0}, .value = {-1.0, 0.0, 0.0, 3.0}, .std = {}},
          .curvature = {.at = {-1.0, 1.0}, .value = {-1.5, 1.5}, .std = {}},
          .lag = 0.4,
          .steering_lag = 0.15,
          .cornering_drag = 0.1,
          .understeer = 0.05};
}

CarBatch<double> driven(const std::vector<double>& throttle, const std::vector<double>& steering,
                        const RolloutStart& start, const std::vector<DriveCommand>& past) {
  const RolloutBatch<double> batch{.rollouts = throttle.size() / kCarPeriods,
                                   .periods = kCarPeriods,
                                   .commands = {throttle.data(), steering.data(), kCarPeriods, 1},
                                   .starts = {&start, 1},
                                   .past = past};
  return car_batch(car(), batch, kCarPeriod);
}

TEST_CASE("from rest each period has the mean twist of the car's curves") {
  const std::vector<double> throttle(kCarPeriods, 0.6), steering(kCarPeriods, 0.5);
  const auto found = driven(throttle, steering, {}, {{.v = 0.0, .omega = 0.0}});
  std::vector<double> t;
  std::vector<BodyTwist> commands;
  for (std::size_t k = 0; k < kCarPeriods; ++k) {
    t.push_back(kCarPeriod * static_cast<double>(k));
    commands.push_back({.v = 0.6, .vy = 0.0, .omega = 0.5});
  }
  const InputHistory twists = car_twists(car(), {t, commands}, {.start = 0.0, .end = kCarPeriod * kCarPeriods});
  double along = 0.0, turned = 0.0;
  for (std::size_t k = 0; k < twists.size(); ++k) {
    const double end = k + 1 < twists.size() ? twists.time(k + 1) : kCarPeriod * kCarPeriods;
    along += twists.sample(k).v * (end - twists.time(k));
    turned += twists.sample(k).omega * (end - twists.time(k));
  }
  double v = 0.0, omega = 0.0;
  for (std::size_t k = 0; k < kCarPeriods; ++k) {
    v += kCarPeriod * found.v[k];
    omega += kCarPeriod * found.omega[k];
  }
  CHECK(v == doctest::Approx(along).epsilon(1e-3));
  CHECK(omega == doctest::Approx(turned).epsilon(1e-3));
}

TEST_CASE("a car that turns goes on turning where its steering is held, though nothing is known of the past") {
  const CarState held{.speed = 1.2, .steering = 0.4};
  const BodyTwist now = car_twist(car(), held);
  const RolloutStart start{.pose = {}, .drive = {.v = now.v, .omega = now.omega}};
  const std::vector<double> throttle(kCarPeriods, 0.6), steering(kCarPeriods, 0.4);
  const auto found = driven(throttle, steering, start, {});
  CHECK(found.past.empty());
  CHECK(found.v[0] == doctest::Approx(1.2).epsilon(0.05));
  CHECK(found.omega[0] / found.v[0] == doctest::Approx(now.omega / now.v).epsilon(0.02));
}

TEST_CASE("steering sent before is still on its way, and twists of the past have the speed of the start") {
  const RolloutStart start{.pose = {}, .drive = {.v = 1.0, .omega = 0.0}};
  const std::vector<double> throttle(kCarPeriods, 0.5), steering(kCarPeriods, 0.0);
  const std::vector<DriveCommand> past{{.v = 0.5, .omega = 0.0}, {.v = 0.5, .omega = 1.0}};
  const auto found = driven(throttle, steering, start, past);
  REQUIRE(found.past.size() == 2);
  CHECK(found.past[0].omega == doctest::Approx(0.0));
  CHECK(found.past[1].v == doctest::Approx(1.0));
  CHECK(found.past[1].omega > 0.3);
  CHECK(found.omega[0] > 0.2);
  CHECK(found.omega[kCarPeriods - 1] == doctest::Approx(0.0).epsilon(1e-3));
}

TEST_CASE("a car that hears its commands late does what its twists say, with those that were sent before the start") {
  for (const double delay : {0.05, 0.1, 0.23}) {
    CarCurves late = car();
    late.delay = delay;
    std::vector<double> t, throttle, steering;
    std::vector<BodyTwist> commands;
    std::vector<DriveCommand> past;
    constexpr int kSent = 4;
    for (int k = -kSent; k < static_cast<int>(kCarPeriods); ++k) {
      const BodyTwist command{.v = 0.55 + 0.2 * std::sin(1.3 * k), .vy = 0.0, .omega = 0.6 * std::cos(0.4 * k)};
      t.push_back(kCarPeriod * k);
      commands.push_back(command);
      if (k < 0) {
        past.push_back({.v = command.v, .omega = command.omega});
      } else {
        throttle.push_back(command.v);
        steering.push_back(command.omega);
      }
    }
    const RolloutStart start{.pose = {}, .drive = {.v = 1.1, .omega = 0.4}};
    const RolloutBatch<double> batch{.rollouts = 1,
                                     .periods = kCarPeriods,
                                     .commands = {throttle.data(), steering.data(), kCarPeriods, 1},
                                     .starts = {&start, 1},
                                     .past = past};
    const CarBatch<double> found = car_batch(late, batch, kCarPeriod);
    REQUIRE(found.past.size() == kSent);
    const InputHistory twists =
        car_twists(late, {t, commands},
                   {.start = 0.0, .end = kCarPeriod * kCarPeriods, .measured = KnownMotion{.t = 0.0, .speed = 1.1}});
    double along = 0.0, turned = 0.0, v = 0.0, omega = 0.0;
    for (std::size_t k = 0; k < kCarPeriods; ++k) {
      for (int part = 0; part < 100; ++part) {
        const BodyTwist twist = twists.at(kCarPeriod * (static_cast<double>(k) + 0.01 * (part + 0.5)));
        along += 0.01 * kCarPeriod * twist.v;
        turned += 0.01 * kCarPeriod * twist.omega;
      }
      v += kCarPeriod * found.v[k];
      omega += kCarPeriod * found.omega[k];
      CHECK(std::abs(v - along) < 0.015);
      CHECK(std::abs(omega - turned) < 0.04);
    }
  }
}

TEST_CASE("a car that hears late goes on as it does where nothing is known of what was sent") {
  CarCurves late = car();
  late.delay = 0.2;
  const RolloutStart start{.pose = {}, .drive = {.v = 1.2, .omega = 0.5}};
  const std::vector<double> throttle(kCarPeriods, 0.0), steering(kCarPeriods, 0.0);
  const RolloutBatch<double> batch{.rollouts = 1,
                                   .periods = kCarPeriods,
                                   .commands = {throttle.data(), steering.data(), kCarPeriods, 1},
                                   .starts = {&start, 1}};
  const CarBatch<double> found = car_batch(late, batch, kCarPeriod);
  CHECK(found.v[1] == 1.2);
  CHECK(found.omega[1] == 0.5);
  CHECK(found.v[2] < 1.1);
  for (const double impossible : {-0.1, 1e9, std::nan("")}) {
    late.delay = impossible;
    CHECK_THROWS_AS(car_batch(late, batch, kCarPeriod), std::invalid_argument);
  }
}

/// One car by the laws in doubles, step by step.
BodyTwist mean_of_period(CarState& state, const BodyTwist& command, double period) {
  const int steps = 5;  // of 20 ms
  BodyTwist mean;
  for (int i = 0; i < steps; ++i) {
    const CarState before = state;
    state = advanced(car(), state, command, period / steps);
    const BodyTwist now = car_twist(
        car(), {.speed = 0.5 * (before.speed + state.speed), .steering = 0.5 * (before.steering + state.steering)});
    mean.v += now.v / steps;
    mean.omega += now.omega / steps;
  }
  return mean;
}

/// Largest difference of the lanes to that.
template <typename Scalar>
double apart_from_laws(InstructionLevel level) {
  constexpr std::size_t kRollouts = 37;  // no whole number of blocks
  std::vector<Scalar> throttle, steering;
  for (std::size_t i = 0; i < kRollouts * kCarPeriods; ++i) {
    throttle.push_back(static_cast<Scalar>(std::sin(0.37 * static_cast<double>(i))));
    steering.push_back(static_cast<Scalar>(1.1 * std::cos(0.21 * static_cast<double>(i))));
  }
  const std::array<RolloutStart, 1> start{{{.pose = {}, .drive = {.v = 0.7, .omega = 0.3}}}};
  const RolloutBatch<Scalar> batch{.rollouts = kRollouts,
                                   .periods = kCarPeriods,
                                   .commands = {throttle.data(), steering.data(), 1, kRollouts},
                                   .starts = start};
  const CarBatch<Scalar> found = car_batch(car(), batch, kCarPeriod, {.threads = 2, .level = level});
  double worst = 0.0;
  for (std::size_t n = 0; n < kRollouts; ++n) {
    const double steers = 0.3 / 0.7 * (1.0 + car().understeer * 0.49) / 1.5;  // its curve is straight
    CarState state{.speed = 0.7, .steering = steers};
    for (std::size_t k = 0; k < kCarPeriods; ++k) {
      const std::size_t i = k * kRollouts + n;
      const BodyTwist mean = mean_of_period(
          state, {.v = static_cast<double>(throttle[i]), .vy = 0.0, .omega = static_cast<double>(steering[i])},
          kCarPeriod);
      worst = std::max({worst, std::abs(static_cast<double>(found.v[i]) - mean.v),
                        std::abs(static_cast<double>(found.omega[i]) - mean.omega)});
    }
  }
  return worst;
}

TEST_CASE("lanes of cars are the laws in doubles to rounding, at every instruction level") {
  for (const InstructionLevel level : kInstructionLevels) {
    if (has_instruction_level(level)) {
      CAPTURE(name_of(level));
      CHECK(apart_from_laws<double>(level) < 1e-10);
      CHECK(apart_from_laws<float>(level) < 2e-5);
    }
  }
}

TEST_CASE("rollouts lie side by side and do not touch each other; numbers that do not fit are refused") {
  std::vector<double> throttle(2 * kCarPeriods, 0.6), steering(2 * kCarPeriods, 0.0);
  for (std::size_t k = kCarPeriods; k < 2 * kCarPeriods; ++k) {
    throttle[k] = -1.0;
  }
  const auto both = driven(throttle, steering, {}, {});
  const auto one = driven({throttle.begin(), throttle.begin() + kCarPeriods}, steering, {}, {});
  for (std::size_t k = 0; k < kCarPeriods; ++k) {
    CHECK(both.v[2 * k] == one.v[k]);
    CHECK(both.v[2 * k + 1] < 0.0);
  }
  const std::array<RolloutStart, 3> starts{};
  const RolloutBatch<double> batch{.rollouts = 2,
                                   .periods = kCarPeriods,
                                   .commands = {throttle.data(), steering.data(), kCarPeriods, 1},
                                   .starts = starts};
  CHECK_THROWS_AS(car_batch(car(), batch, kCarPeriod), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
