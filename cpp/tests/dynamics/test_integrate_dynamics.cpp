// SPDX-License-Identifier: Apache-2.0
// Integrated dynamics agree with closed forms and with finite differences.
#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>

#include "sample_dynamics.hpp"
#include "slipwise/dynamics/integrate_dynamics.hpp"

namespace slipwise {
namespace {

HeldInputs force(double before, double after) {
  HeldInputs inputs;
  inputs.push(0.0, Eigen::VectorXd::Constant(1, before));
  inputs.push(0.73, Eigen::VectorXd::Constant(1, after));
  return inputs;
}

TEST_CASE("a cart with drag is where its closed form says, inputs changing on the way") {
  const double drag = 0.8, gain = 1.3;
  const auto driven = [&](Eigen::Vector2d at, double u, double seconds) {
    const double decay = std::exp(-drag * seconds), top = gain * u / drag;
    return Eigen::Vector2d(at[0] + top * seconds + (at[1] - top) * (1.0 - decay) / drag, top + (at[1] - top) * decay);
  };
  const Eigen::Vector2d start(0.5, -0.4);
  const Eigen::Vector2d expected = driven(driven(start, 1.0, 0.73), -0.5, 1.27);
  const Eigen::VectorXd psd = Eigen::VectorXd::Zero(2);
  const DynamicsSpan span{.start = 0.0, .end = 2.0, .longest_step = 0.05, .psd = psd};
  const HeldInputs inputs = force(1.0, -0.5);
  const Eigen::Vector2d parameters(drag, gain);
  const DynamicsEnd end = integrate_dynamics(tests::Cart(), inputs, span, start, parameters);
  CHECK((end.state - expected).norm() < 1e-6);
  CHECK((dynamics_state(tests::Cart(), inputs, span, start, parameters) - end.state).norm() < 1e-12);
}

TEST_CASE("the derivatives of the end by start and parameters are exact, with Jacobians of a user and without") {
  const Eigen::Vector3d start(0.4, 0.9, 0.0);
  const Eigen::Vector2d parameters(0.3, 1.1);
  HeldInputs inputs;
  inputs.push(0.0, Eigen::Vector2d(0.5, 0.4));
  inputs.push(0.6, Eigen::Vector2d(-0.2, -0.8));
  const Eigen::VectorXd psd = Eigen::VectorXd::Zero(3);
  const DynamicsSpan span{.start = 0.1, .end = 1.7, .longest_step = 0.05, .psd = psd};
  const DynamicsEnd end = integrate_dynamics(tests::Boat(), inputs, span, start, parameters);
  Eigen::VectorXd all(5);
  all << start, parameters;
  for (Eigen::Index i = 0; i < all.size(); ++i) {
    const auto at = [&](double sign) {
      Eigen::VectorXd moved = all;
      moved[i] += sign * 1e-5;
      return dynamics_state(tests::Boat(), inputs, span, moved.head(3), moved.tail(2));
    };
    const Eigen::VectorXd difference = (at(1.0) - at(-1.0)) / 2e-5;
    CHECK((end.by_start.col(i) - difference).norm() < 1e-6);
  }
  const HeldInputs pushed = force(1.0, -0.5);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(2);
  const DynamicsSpan cart{.start = 0.0, .end = 1.0, .longest_step = 0.05, .psd = none};
  const auto differences = integrate_dynamics(tests::Cart(), pushed, cart, start.head(2), parameters);
  const auto exact = integrate_dynamics(tests::CartWithJacobians(), pushed, cart, start.head(2), parameters);
  CHECK((differences.by_start - exact.by_start).norm() < 1e-8);
}

TEST_CASE("noise adds up as the closed form of a speed with drag says") {
  const double drag = 0.8, density = 0.3, seconds = 2.0;
  const Eigen::VectorXd psd = Eigen::Vector2d(0.0, density);
  const HeldInputs inputs = force(0.0, 0.0);
  const DynamicsSpan span{.start = 0.0, .end = seconds, .longest_step = 0.02, .psd = psd};
  const DynamicsEnd end =
      integrate_dynamics(tests::Cart(), inputs, span, Eigen::Vector2d::Zero(), Eigen::Vector2d(drag, 1.0));
  const double speed = density * (1.0 - std::exp(-2.0 * drag * seconds)) / (2.0 * drag);
  const double d = std::exp(-drag * seconds);
  const double place = density / (drag * drag) * (seconds - 2.0 * (1.0 - d) / drag + (1.0 - d * d) / (2.0 * drag));
  CHECK(end.noise(1, 1) == doctest::Approx(speed).epsilon(1e-3));
  CHECK(end.noise(0, 0) == doctest::Approx(place).epsilon(1e-3));
  CHECK(end.noise(0, 1) == doctest::Approx(end.noise(1, 0)).epsilon(1e-12));
}

TEST_CASE("dynamics that run away are said to, and inputs that are not known yet") {
  const Eigen::VectorXd psd = Eigen::VectorXd::Zero(3);
  HeldInputs inputs;
  inputs.push(0.0, Eigen::Vector2d(0.0, 0.0));
  const DynamicsSpan span{.start = 0.0, .end = 50.0, .longest_step = 0.05, .psd = psd};
  const Eigen::Vector3d start(0.0, -10.0, 0.0);
  const Eigen::Vector2d negative_drag(-1.0, 0.0);
  CHECK_THROWS_AS(integrate_dynamics(tests::Boat(), inputs, span, start, negative_drag), std::runtime_error);
  const DynamicsSpan early{.start = -1.0, .end = 1.0, .longest_step = 0.05, .psd = psd};
  CHECK_THROWS_AS(dynamics_state(tests::Boat(), inputs, early, start, negative_drag), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
