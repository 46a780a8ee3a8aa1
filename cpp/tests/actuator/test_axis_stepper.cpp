// SPDX-License-Identifier: Apache-2.0
// The derivatives that an axis carries along equal finite differences over several steps.
#include "slipwise/actuator/axis_stepper.hpp"

#include <doctest/doctest.h>

#include <array>

#include "finite_difference.hpp"

namespace slipwise {
namespace {

constexpr int kN = 6;
constexpr AxisPlaces kPlaces{.time_constant = 0, .delay = 1, .gain = 2, .slow_fraction = 3, .slow_time_constant = 4};
constexpr Eigen::Index kFactor = 5;  // of the inputs, which no axis knows of
constexpr std::array kInputs{1.0, -0.5, 0.8};
constexpr std::array kDurations{0.3, 0.2, 0.4};

AxisResponse response_of(const Eigen::VectorXd& at) {
  return {.gain = at[2], .time_constant = at[0], .slow_fraction = at[3], .slow_time_constant = at[4]};
}

/// By how much the i-th step lasts longer with place 1.
template <int N>
Eigen::Matrix<double, 1, N> longer(std::size_t i) {
  Eigen::Matrix<double, 1, N> row = Eigen::Matrix<double, 1, N>::Zero();
  if constexpr (N > 0) {
    row[kPlaces.delay] = i == 1 ? 1.0 : 0.0;
  }
  return row;
}

/// Integral, and both modes at the end, each with its derivatives; `hold` gives the stepper an input.
template <int N, typename Hold>
Eigen::Matrix<double, 3, N + 1> driven(const Eigen::VectorXd& at, const AxisPlaces& places, const Hold& hold) {
  AxisStepper<N> axis(response_of(at), places);
  axis.start({.value = 0.3}, {.value = -0.1});
  Sensitive<N> integral;
  for (std::size_t i = 0; i < kInputs.size(); ++i) {
    hold(axis, kInputs.at(i));
    const double duration = kDurations.at(i) + (i == 1 ? at[1] : 0.0);
    integral = integral + axis.advance(AxisDecay(axis.response(), duration), longer<N>(i));
  }
  Eigen::Matrix<double, 3, N + 1> result;
  result << integral.value, integral.derivative, axis.fast().value, axis.fast().derivative, axis.slow().value,
      axis.slow().derivative;
  return result;
}

template <int N>
Eigen::Matrix<double, 3, N + 1> driven(const Eigen::VectorXd& at) {
  return driven<N>(at, kPlaces, [](AxisStepper<N>& axis, double input) { axis.hold(input); });
}

Eigen::VectorXd sample() { return (Eigen::VectorXd(kN) << 0.25, 0.05, 0.9, 0.3, 1.4, 1.0).finished(); }

TEST_CASE("integral and modes know their derivatives by lag, delay, gain and slow mode") {
  const auto value = [](const Eigen::VectorXd& at) -> Eigen::VectorXd { return driven<kN>(at).col(0); };
  const Eigen::MatrixXd numeric = tests::finite_difference(value, sample(), 0.02);
  CHECK(tests::jacobian_error(driven<kN>(sample()).rightCols<kN>(), numeric) < tests::kDerivativeTolerance);
}

TEST_CASE("an input that moves with a parameter hands its derivative on") {
  const auto run = [](const Eigen::VectorXd& at) {
    return driven<kN>(at, {}, [&](AxisStepper<kN>& axis, double input) {
      axis.hold({.value = at[kFactor] * input, .derivative = input * Eigen::Matrix<double, 1, kN>::Unit(kFactor)});
    });
  };
  const auto value = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd { return run(at).col(0); };
  const Eigen::MatrixXd numeric = tests::finite_difference(value, sample(), 0.02);
  CHECK(tests::jacobian_error(run(sample()).col(1 + kFactor), numeric.col(kFactor)) < tests::kDerivativeTolerance);
}

TEST_CASE("the values are the same without derivatives") {
  CHECK(driven<0>(sample()).col(0) == driven<kN>(sample()).col(0));
}

TEST_CASE("following ends where advancing does") {
  AxisStepper<kN> followed(response_of(sample()), kPlaces);
  followed.settle(0.4);
  followed.hold(1.0);
  AxisStepper<kN> advanced = followed;
  const AxisDecay decay(followed.response(), 0.35);
  followed.follow(decay, longer<kN>(1));
  advanced.advance(decay, longer<kN>(1));
  CHECK(followed.whole().value == advanced.whole().value);
  CHECK(followed.whole().derivative == advanced.whole().derivative);
}

TEST_CASE("fast and slow mode of a settled axis make up the gain") {
  AxisStepper<kN> axis({.gain = 0.7, .time_constant = 0.1, .slow_fraction = 0.4, .slow_time_constant = 2.0}, kPlaces);
  axis.settle(2.0);
  CHECK(axis.whole().value == doctest::Approx(1.4));
  CHECK(axis.whole().derivative[kPlaces.slow_fraction] == doctest::Approx(0.0));
  CHECK(axis.whole().derivative[kPlaces.gain] == doctest::Approx(2.0));
}

TEST_CASE("what was measured before any input is kept") {
  AxisStepper<kN> axis(response_of(sample()), kPlaces);
  axis.settle(0.0);
  axis.keep(0.6);
  CHECK(axis.advance(AxisDecay(axis.response(), 2.0), longer<kN>(0)).value == doctest::Approx(1.2));
  CHECK(axis.whole().value == doctest::Approx(0.6));
}

TEST_CASE("an axis that never moved has no derivatives") {
  AxisStepper<kN> axis(response_of(sample()), kPlaces);
  axis.settle(0.0);
  CHECK(axis.advance(AxisDecay(axis.response(), 1.0), longer<kN>(1)).derivative.isZero(0.0));
}

}  // namespace
}  // namespace slipwise
