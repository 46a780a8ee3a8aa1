// SPDX-License-Identifier: Apache-2.0
// A car commanded by throttle and steering: its curves, its lag, and what was measured of it.
#include "slipwise/actuator/car_curves.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <memory>

namespace slipwise {
namespace {

CarCurves sample_car() {
  return {.speed = {.at = {-1.0, 0.0, 0.2, 1.0}, .value = {-2.0, 0.0, 0.0, 4.0}, .std = {}},
          .curvature = {.at = {-1.0, 1.0}, .value = {-2.0, 2.0}, .std = {}},
          .lag = 0.5,
          .steering_lag = 0.1,
          .cornering_drag = 0.2,
          .understeer = 0.1};
}

InputHistory held(double throttle, double steering) { return {{0.0}, {{.v = throttle, .vy = 0.0, .omega = steering}}}; }

BodyTwist last_of(const InputHistory& twists) { return twists.sample(twists.size() - 1); }

TEST_CASE("a curve is straight between its knots and level beyond them") {
  const KnotCurve curve{.at = {0.0, 1.0, 3.0}, .value = {1.0, 2.0, 0.0}, .std = {}};
  CHECK(curve(-1.0) == 1.0);
  CHECK(curve(0.5) == doctest::Approx(1.5));
  CHECK(curve(2.0) == doctest::Approx(1.0));
  CHECK(curve(9.0) == 0.0);
  CHECK(KnotCurve{}(1.0) == 0.0);
}

TEST_CASE("deviations make up the prior's part of the covariance of the numbers that the commands touch") {
  CarCurves car = sample_car();
  const Eigen::Index size = car_numbers(car).size();
  Eigen::VectorXd prior(size);
  prior << 2.0, 0.0, 1.0, 3.0, 1.0, 1.0, 0.5, 0.2, 0.3, 0.2;  // speed at -1, 0, 0.2 and 1, curvature at -1 and 1
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  covariance.diagonal() << 4.0, 0.0, 0.01, 8.01, 1.0, 1.0, 0.25, 0.04, 0.09, 0.04;
  covariance(2, 3) = covariance(3, 2) = 0.01;  // the first increment is known to 0.1, the second not at all
  car.spread = std::make_shared<const CarSpread>(CarSpread{covariance, prior});
  const auto sum_under = [&car](double throttle) {
    const CarDeviations deviations = car_deviations(car, held(throttle, 0.5));
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(car_numbers(car).size(), car_numbers(car).size());
    for (const CarCurves& each : deviations.cars) {
      const Eigen::VectorXd off = (car_numbers(each) - car_numbers(car)) / deviations.step;
      sum += off * off.transpose();
    }
    return sum;
  };
  const Eigen::MatrixXd slow = sum_under(0.1), fast = sum_under(0.9);
  CHECK(slow(2, 2) == doctest::Approx(1e-4));  // of 0.01, what a prior of 1 leaves
  CHECK(slow(3, 3) == 0.0);                    // not touched
  CHECK(fast(3, 3) == doctest::Approx(8.0 + 1e-4).epsilon(1e-3));
  for (const Eigen::Index never : {4, 5, 6, 7, 8, 9}) {  // as before any drive
    CHECK(fast(never, never) == doctest::Approx(covariance(never, never)));
  }
  CHECK(car_deviations(sample_car(), held(0.1, 0.5)).cars.empty());
  Eigen::VectorXd unstated = Eigen::VectorXd::Zero(size);
  car.spread = std::make_shared<const CarSpread>(CarSpread{covariance, unstated});
  CHECK(car_deviations(car, held(0.9, 0.5)).cars.empty());
}

TEST_CASE("a throttle within the dead zone moves nothing") {
  const InputHistory twists = car_twists(sample_car(), held(0.2, 1.0), {.start = 0.0, .end = 3.0});
  CHECK(last_of(twists).v == 0.0);
  CHECK(last_of(twists).omega == 0.0);
}

TEST_CASE("a steady car balances its throttle and the drag of its turn") {
  const CarCurves car = sample_car();
  const BodyTwist twist = last_of(car_twists(car, held(0.6, 0.5), {.start = 0.0, .end = 20.0}));
  CHECK(twist.v * (1.0 + 0.2 * std::abs(twist.omega)) == doctest::Approx(2.0).epsilon(1e-3));
  CHECK(twist.omega * (1.0 + 0.1 * twist.v * twist.v) == doctest::Approx(twist.v).epsilon(1e-3));
}

TEST_CASE("left mirrors right") {
  const CarCurves car = sample_car();
  const InputHistory left = car_twists(car, held(0.6, 0.5), {.start = 0.0, .end = 2.0});
  const InputHistory right = car_twists(car, held(0.6, -0.5), {.start = 0.0, .end = 2.0});
  REQUIRE(left.size() == right.size());
  for (std::size_t i = 0; i < left.size(); ++i) {
    CHECK(left.sample(i).v == doctest::Approx(right.sample(i).v));
    CHECK(left.sample(i).omega == doctest::Approx(-right.sample(i).omega));
  }
}

TEST_CASE("without a turn the speed lags its command exactly") {
  const CarState after = advanced(sample_car(), {}, {.v = 0.6, .vy = 0.0, .omega = 0.0}, 0.25);
  CHECK(after.speed == doctest::Approx(2.0 * (1.0 - std::exp(-0.5))));
}

TEST_CASE("a measured motion is gone on from, and what the curves do not say dies away") {
  const CarCurves car = sample_car();
  const KnownMotion measured{
      .t = 1.0, .speed = 3.0, .turn = 0.4, .turn_lag = 0.25, .sideways = -0.5, .sideways_lag = 0.5};
  const InputHistory twists = car_twists(car, held(1.0, 0.0), {.start = 1.0, .end = 2.0, .measured = measured});
  const BodyTwist first = twists.sample(0);
  CHECK(first.v == doctest::Approx(4.0 - std::exp(-0.05)).epsilon(5e-3));  // about the middle of the first piece
  CHECK(first.omega == doctest::Approx(0.4 * std::exp(-0.1)).epsilon(3e-2));
  CHECK(first.vy == doctest::Approx(-0.5 * std::exp(-0.05)).epsilon(3e-2));
  CHECK(std::abs(last_of(twists).omega) < 0.4 * std::exp(-3.5));
}

TEST_CASE("a car that hears its commands late does the same later, and goes on as it was measured until it hears") {
  CarCurves late = sample_car();
  late.delay = 0.3;
  const InputHistory prompt = car_twists(sample_car(), held(0.6, 0.5), {.start = 0.0, .end = 2.0});
  const InputHistory delayed = car_twists(late, held(0.6, 0.5), {.start = 0.0, .end = 2.3});
  CHECK(delayed.at(0.25).v == 0.0);
  for (double t = 0.03; t < 1.9; t += 0.06) {  // amid pieces
    CHECK(delayed.at(t + 0.3).v == doctest::Approx(prompt.at(t).v));
    CHECK(delayed.at(t + 0.3).omega == doctest::Approx(prompt.at(t).omega));
  }
  const KnownMotion measured{.t = 0.1, .speed = 1.5};
  const InputHistory moving = car_twists(late, held(0.0, 0.0), {.start = 0.1, .end = 1.0, .measured = measured});
  CHECK(moving.at(0.25).v == 1.5);
  CHECK(moving.at(0.45).v < 1.4);
}

TEST_CASE("commands later than a moment change nothing before it") {
  const CarCurves car = sample_car();
  const InputHistory one({0.0}, {{.v = 0.6, .vy = 0.0, .omega = 0.2}});
  const InputHistory two({0.0, 1.0}, {{.v = 0.6, .vy = 0.0, .omega = 0.2}, {.v = -1.0, .vy = 0.0, .omega = -1.0}});
  const InputHistory before = car_twists(car, one, {.start = 0.0, .end = 2.0});
  const InputHistory other = car_twists(car, two, {.start = 0.0, .end = 2.0});
  for (double t = 0.0; t < 0.94; t += 0.05) {
    CHECK(before.at(t) == other.at(t));
  }
  CHECK(before.at(1.9) != other.at(1.9));
}

TEST_CASE("a car is settled when its twist no longer changes, counted from the last command or the start") {
  const CarCurves car = sample_car();
  const InputHistory commands({0.0, 1.0}, {{.v = 0.6, .vy = 0.0, .omega = 0.2}, {.v = 1.0, .vy = 0.0, .omega = 0.5}});
  const double settled = settled_after(car, commands, 0.0);
  CHECK(settled_after(car, commands, 3.0) == doctest::Approx(settled + 2.0));
  CHECK(settled_after(car, InputHistory(), 3.0) == doctest::Approx(settled + 2.0));
  const BodyTwist then = last_of(car_twists(car, commands, {.start = 0.0, .end = settled}));
  const BodyTwist later = last_of(car_twists(car, commands, {.start = 0.0, .end = settled + 20.0}));
  CHECK(then.v == doctest::Approx(later.v).epsilon(0.02));
  CHECK(then.omega == doctest::Approx(later.omega).epsilon(0.02));
}

}  // namespace
}  // namespace slipwise
