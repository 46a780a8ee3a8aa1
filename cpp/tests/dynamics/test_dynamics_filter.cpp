// SPDX-License-Identifier: Apache-2.0
// State and parameters are learned together, with covariances that hold.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>

#include "sample_dynamics.hpp"
#include "slipwise/dynamics/dynamics_filter.hpp"
#include "slipwise/lie/angle.hpp"
#include "slipwise/linear/innovation.hpp"

namespace slipwise {
namespace {

constexpr double kPeriod = 0.1;  // [s] between measurements
constexpr double kMeasured = 0.02;
constexpr double kDensity = 0.01;  // of what adds to the acceleration

DynamicsSettings cart_settings() {
  return {.noise = {.measured = {0},
                    .angle = {false},
                    .measurement_std = Eigen::VectorXd::Constant(1, kMeasured),
                    .psd = Eigen::Vector2d(0.0, kDensity)}};
}

Estimate cart_start() {
  const Eigen::Vector4d std(0.05, 0.3, 0.3, 0.3);
  return {Eigen::Vector4d(0.0, 0.0, 0.5, 1.0), std.cwiseAbs2().asDiagonal()};
}

/// A cart whose truth is drawn from the start's covariance; `colour` [s] of its measurement noise, 0 for white noise.
struct SimulatedCart {
  std::mt19937_64 random;
  std::normal_distribution<double> normal;
  Eigen::Vector2d state;
  Eigen::Vector2d parameters;
  double colour = 0.0;
  double error = 0.0;
  double t = 0.0;

  SimulatedCart(unsigned seed, double colour_seconds) : random(seed), colour(colour_seconds) {
    const Estimate start = cart_start();
    Eigen::VectorXd truth = start.mean;
    for (Eigen::Index i = 0; i < truth.size(); ++i) {
      truth[i] += std::sqrt(start.covariance(i, i)) * normal(random);
    }
    state = truth.head(2);
    parameters = truth.tail(2);
  }

  double input() const { return std::sin(1.3 * t) + (std::fmod(t, 8.0) < 4.0 ? 1.0 : -1.0); }

  /// The place as it is measured one period later.
  Eigen::VectorXd drive(const Eigen::VectorXd& force) {
    constexpr int kParts = 20;
    const double h = kPeriod / kParts;
    for (int i = 0; i < kParts; ++i) {
      const Eigen::Vector2d middle = state + 0.5 * h * tests::Cart().derivative(state, force, parameters);
      state += h * tests::Cart().derivative(middle, force, parameters);
      state[1] += std::sqrt(kDensity * h) * normal(random);
    }
    t += kPeriod;
    const double keep = colour > 0.0 ? std::exp(-kPeriod / colour) : 0.0;
    error = keep * error + std::sqrt(1.0 - keep * keep) * kMeasured * normal(random);
    return Eigen::VectorXd::Constant(1, state[0] + error);
  }
};

struct Consistency {
  double nis = 0.0;       ///< mean
  double nees = 0.0;      ///< mean, of the parameters as the filter knows them
  double reported = 0.0;  ///< the same as they are reported
};

Consistency consistency(double colour, int runs, int measurements) {
  Consistency mean;
  for (int run = 0; run < runs; ++run) {
    SimulatedCart cart(static_cast<unsigned>(run), colour);
    DynamicsFilter filter(std::make_shared<const tests::Cart>(), cart_settings(), 0.0, cart_start());
    for (int i = 0; i < measurements; ++i) {
      const Eigen::VectorXd force = Eigen::VectorXd::Constant(1, cart.input());
      filter.push_input(cart.t, force);
      const Eigen::VectorXd measured = cart.drive(force);
      mean.nis += filter.push_measurement(cart.t, measured).nis / measurements / runs;
    }
    const Eigen::VectorXd error = cart.parameters - filter.parameters().mean;
    mean.nees += normalised_square(error, filter.parameters().covariance) / runs;
    mean.reported += normalised_square(error, filter.reported_parameters().covariance) / runs;
  }
  return mean;
}

TEST_CASE("over simulated drives with white noise the covariances of innovations and parameters hold") {
  const Consistency found = consistency(0.0, 100, 300);
  CHECK(found.nis == doctest::Approx(1.0).epsilon(0.05));
  CHECK(found.nees > 1.6);  // 2 parameters, 100 runs: 95 % lie between 1.62 and 2.41
  CHECK(found.nees < 2.45);
  CHECK(found.reported > 1.3);
  CHECK(found.reported < 2.6);
}

TEST_CASE("with noise that is correlated over a second the reported covariance holds, and the plain one does not") {
  const Consistency found = consistency(1.0, 100, 300);
  CHECK(found.reported < 0.75 * found.nees);
  CHECK(found.reported < 3.2);
}

TEST_CASE("an angle is measured without whole turns") {
  const DynamicsSettings settings{.noise = {.measured = {0},
                                            .angle = {true},
                                            .measurement_std = Eigen::VectorXd::Constant(1, 0.01),
                                            .psd = Eigen::VectorXd::Constant(1, 1e-6)}};
  const Estimate start{Eigen::Vector2d(0.0, 1.0), Eigen::Vector2d(1e-4, 0.09).asDiagonal()};
  DynamicsFilter filter(std::make_shared<const tests::Hand>(), settings, 0.0, start);
  filter.push_input(0.0, Eigen::VectorXd::Constant(1, 1.0));
  for (int i = 1; i <= 100; ++i) {
    const double t = 0.2 * i;
    filter.push_measurement(t, Eigen::VectorXd::Constant(1, wrap_angle(1.2 * t)));
  }
  CHECK(filter.parameters().mean[0] == doctest::Approx(1.2).epsilon(0.01));
  CHECK(filter.state().mean[0] == doctest::Approx(24.0).epsilon(0.01));
}

TEST_CASE("an outlier is rejected, and a state that is elsewhere is found again") {
  SimulatedCart cart(5, 0.0);
  DynamicsFilter filter(std::make_shared<const tests::Cart>(), cart_settings(), 0.0, cart_start());
  for (int i = 0; i < 200; ++i) {
    const Eigen::VectorXd force = Eigen::VectorXd::Constant(1, cart.input());
    filter.push_input(cart.t, force);
    Eigen::VectorXd measured = cart.drive(force);
    const bool outlier = i == 50;
    measured[0] += outlier ? 3.0 : 0.0;
    const DynamicsUpdate update = filter.push_measurement(cart.t, measured);
    CHECK((update.status == Status::Rejected) == outlier);
  }
  const Eigen::VectorXd nowhere = Eigen::VectorXd::Constant(1, cart.state[0] + 100.0);
  int rejected = 0;
  for (int i = 1; i <= 10; ++i) {
    rejected += filter.push_measurement(cart.t + 0.1 * i, nowhere).status == Status::Rejected ? 1 : 0;
  }
  CHECK(rejected >= 5);
  CHECK(rejected < 10);
}

TEST_CASE("predictions are where the state goes, wider the later") {
  SimulatedCart cart(3, 0.0);
  DynamicsFilter filter(std::make_shared<const tests::Cart>(), cart_settings(), 0.0, cart_start());
  filter.push_input(0.0, Eigen::VectorXd::Constant(1, 1.0));
  filter.push_measurement(0.1, Eigen::VectorXd::Constant(1, 0.0));
  HeldInputs none;
  const auto found = filter.predict({0.1, 1.1, 2.1}, none);
  REQUIRE(found.size() == 3);
  CHECK(found[0].state == filter.state().mean);
  CHECK(found[1].covariance(0, 0) < found[2].covariance(0, 0));
  const Eigen::VectorXd psd = Eigen::VectorXd::Zero(2);
  HeldInputs held;
  held.push(0.0, Eigen::VectorXd::Constant(1, 1.0));
  const DynamicsSpan span{.start = 0.1, .end = 2.1, .longest_step = 0.05, .psd = psd};
  const Eigen::VectorXd expected =
      dynamics_state(tests::Cart(), held, span, filter.state().mean, filter.parameters().mean);
  CHECK((found[2].state - expected).norm() < 1e-9);
  CHECK_THROWS_AS(filter.predict({0.05}, none), std::invalid_argument);
}

TEST_CASE("what cannot be is refused") {
  const auto cart = std::make_shared<const tests::Cart>();
  DynamicsFilter filter(cart, cart_settings(), 0.0, cart_start());
  const Eigen::VectorXd one = Eigen::VectorXd::Zero(1);
  CHECK_THROWS_AS(filter.push_measurement(1.0, one), std::invalid_argument);  // no input yet
  filter.push_input(0.0, one);
  CHECK_THROWS_AS(filter.push_measurement(0.0, one), std::invalid_argument);
  CHECK_THROWS_AS(filter.push_measurement(1.0, Eigen::Vector2d::Zero()), std::invalid_argument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(filter.push_measurement(1.0, Eigen::VectorXd::Constant(1, nan)), std::invalid_argument);
  DynamicsSettings nowhere = cart_settings();
  nowhere.noise.measured = {2};
  CHECK_THROWS_AS(DynamicsFilter(cart, nowhere, 0.0, cart_start()), std::invalid_argument);
  DynamicsSettings exact = cart_settings();
  exact.noise.measurement_std[0] = 0.0;
  CHECK_THROWS_AS(DynamicsFilter(cart, exact, 0.0, cart_start()), std::invalid_argument);
  CHECK_THROWS_AS(DynamicsFilter(cart, cart_settings(), nan, cart_start()), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
