// SPDX-License-Identifier: Apache-2.0
// The tangent of a step, and its derivatives by what moves the step's duration and integrals.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>

#include "finite_difference.hpp"
#include "sample_bases.hpp"
#include "slipwise/segment/path_step.hpp"

namespace slipwise {
namespace {

using Jacobian = Eigen::Matrix<double, 4, 3>;
constexpr BodyGravity kSlope{.gx = 0.6, .gy = -0.4};

ActuatorStep step_of(const Eigen::Vector4d& at) { return {at[0], at[1], at[2], at[3]}; }

Eigen::Vector3d tangent_at(const Basis& basis, const Eigen::VectorXd& alpha, const Eigen::Vector4d& at) {
  const ActuatorStep step = step_of(at);
  return tangent_of(step, slip_rate(basis, alpha, slip_state(step, kSlope)));
}

TEST_CASE("the slip state is the mean drive over the step, and that of no time is a standstill") {
  const SlipState state = slip_state({.duration = 0.5, .forward = 0.4, .left = 0.0, .turn = -0.1}, kSlope);
  CHECK(state.v == doctest::Approx(0.8));
  CHECK(state.omega == doctest::Approx(-0.2));
  CHECK(state.gx == 0.6);
  CHECK(slip_state({}, kSlope).v == 0.0);
}

TEST_CASE("without slip the tangent is the drive") {
  const ActuatorStep step{.duration = 0.5, .forward = 0.4, .left = 0.1, .turn = -0.1};
  CHECK(tangent_of(step, Eigen::Vector3d::Zero()) == Eigen::Vector3d(0.4, 0.1, -0.1));
}

TEST_CASE("for all bases the tangent's derivative equals finite differences") {
  Jacobian by;
  by << 1.0, 0.0, 0.3, 0.2, 0.5, 0.1, 0.0, 0.2, -0.1, -0.3, 0.4, 0.7;
  const Eigen::Vector4d at(0.3, 0.27, 0.02, 0.15);
  for (const Basis& basis : tests::all_bases()) {
    CAPTURE(basis.name());
    const Eigen::VectorXd alpha = tests::sample_slip(basis, 4);
    const auto value = [&](const Eigen::VectorXd& moved) -> Eigen::VectorXd {
      return tangent_at(basis, alpha, at + by * moved);
    };
    const ActuatorStep step = step_of(at);
    const PathSlip path{.basis = basis, .alpha = alpha, .gravity = kSlope};
    const Eigen::MatrixXd analytic = tangent_by(step, by, path, slip_rate(basis, alpha, slip_state(step, kSlope)));
    const Eigen::MatrixXd numeric = tests::finite_difference(value, Eigen::Vector3d::Zero(), 0.01);
    CHECK(tests::jacobian_error(analytic, numeric) < tests::kDerivativeTolerance);
  }
}

TEST_CASE("a step without duration gains slip at the twist that it begins with") {
  Eigen::Matrix<double, 4, 1> by;
  by << 2.0, 1.6, 0.0, -0.8;  // duration grows twice as fast as the parameter, at 0.8 m/s and -0.4 rad/s
  for (const Basis& basis : tests::all_bases()) {
    const Eigen::VectorXd alpha = tests::sample_slip(basis, 4);
    const PathSlip path{.basis = basis, .alpha = alpha, .gravity = kSlope};
    const Eigen::Vector3d gained = tangent_by({}, by, path, Eigen::Vector3d::Zero());
    constexpr double kMoved = 0.01;  // the twist is constant, so the tangent is linear in the duration
    CHECK((gained * kMoved - tangent_at(basis, alpha, by * kMoved)).norm() < 1e-14);
  }
}

TEST_CASE("a change of a step's tangent moves the start as the end of the path is carried back") {
  const Eigen::Vector3d tangent(0.4, 0.05, 0.3);
  const Pose2 before{.x = 0.7, .y = -0.2, .theta = 0.9};
  Eigen::Matrix2d heading;
  heading << std::cos(before.theta), -std::sin(before.theta), std::sin(before.theta), std::cos(before.theta);
  const Pose2 next = compose(before, exp(tangent));
  const Eigen::Matrix3d analytic = start_by_tangent(heading, tangent, arc_functions(tangent.z()), next);
  // The end in the world, turned about the origin by as much less as the heading grows.
  const auto value = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
    const Pose2 moved = compose(before, exp(Eigen::Vector3d(at)));
    const double back = moved.theta - next.theta;
    return Eigen::Vector3d(moved.x + back * next.y, moved.y - back * next.x, moved.theta);
  };
  CHECK(tests::jacobian_error(analytic, tests::finite_difference(value, tangent, 0.05)) < tests::kDerivativeTolerance);
}

TEST_CASE("a heading stands beside gravity in the slip state") {
  const SlipState state =
      slip_state({.duration = 0.5, .forward = 0.4, .left = 0.0, .turn = 0.0}, headed({.gx = 0.1, .gy = -0.2}, 2.0));
  CHECK(state.gx == 0.1);
  CHECK(state.gy == -0.2);
  CHECK(state.cos_yaw == doctest::Approx(std::cos(2.0)));
  CHECK(state.sin_yaw == doctest::Approx(std::sin(2.0)));
}

}  // namespace
}  // namespace slipwise
