// SPDX-License-Identifier: Apache-2.0
// Every Jacobian of SE(2) against finite differences.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <vector>

#include "finite_difference.hpp"
#include "slipwise/lie/se2.hpp"

namespace slipwise {
namespace {

using tests::finite_difference;
using tests::jacobian_error;
using tests::kDerivativeTolerance;

constexpr double kStep = 0.02;

/// Tangents with turns near zero, at the threshold of the series, and of more than one turn.
std::vector<Eigen::Vector3d> sample_tangents() {
  return {{0.4, -0.3, 0.0},  {1.0, 0.5, 1e-7},  {0.2, 0.9, 0.0299}, {0.2, 0.9, -0.0301},
          {-1.5, 0.2, 0.35}, {2.0, -1.0, -2.4}, {0.7, 0.1, 7.0}};
}

TEST_CASE("the chart Jacobian is the derivative of exp") {
  for (const Eigen::Vector3d& tangent : sample_tangents()) {
    CAPTURE(tangent.z());
    const auto numeric = finite_difference([](const Eigen::VectorXd& t) { return exp(t).vector(); }, tangent, kStep);
    CHECK(jacobian_error(chart_jacobian(tangent), numeric) < kDerivativeTolerance);
  }
}

TEST_CASE("the right Jacobian is the derivative of exp observed from its end") {
  for (const Eigen::Vector3d& tangent : sample_tangents()) {
    CAPTURE(tangent.z());
    const Pose2 back = inverse(exp(tangent));
    const auto numeric =
        finite_difference([&](const Eigen::VectorXd& t) { return log(compose(back, exp(t))); }, tangent, kStep);
    CHECK(jacobian_error(right_jacobian(tangent), numeric) < kDerivativeTolerance);
  }
}

TEST_CASE("the left Jacobian is the derivative of exp observed from its start") {
  for (const Eigen::Vector3d& tangent : sample_tangents()) {
    CAPTURE(tangent.z());
    const Pose2 back = inverse(exp(tangent));
    const auto numeric =
        finite_difference([&](const Eigen::VectorXd& t) { return log(compose(exp(t), back)); }, tangent, kStep);
    CHECK(jacobian_error(left_jacobian(tangent), numeric) < kDerivativeTolerance);
  }
}

TEST_CASE("the left Jacobian is the adjoint times the right Jacobian") {
  for (const Eigen::Vector3d& tangent : sample_tangents()) {
    const Eigen::Matrix3d product = adjoint(exp(tangent)) * right_jacobian(tangent);
    CHECK((left_jacobian(tangent) - product).norm() < 1e-13);
  }
}

TEST_CASE("the adjoint is the derivative of a motion observed from the other frame") {
  const Pose2 pose{1.2, -0.7, 2.1};
  const auto observed = [&](const Eigen::VectorXd& t) { return log(compose(compose(pose, exp(t)), inverse(pose))); };
  const auto numeric = finite_difference(observed, Eigen::Vector3d::Zero(), kStep);
  CHECK(jacobian_error(adjoint(pose), numeric) < kDerivativeTolerance);
}

TEST_CASE("the transition is the derivative of a later pose by an earlier one") {
  const Pose2 earlier{0.4, 1.1, -0.8};
  const Pose2 motion{2.0, -0.6, 1.9};
  const auto later = [&](const Eigen::VectorXd& v) { return compose(Pose2::from_vector(v), motion).vector(); };
  const auto numeric = finite_difference(later, earlier.vector(), kStep);
  CHECK(jacobian_error(transition(earlier, compose(earlier, motion)), numeric) < kDerivativeTolerance);
}

}  // namespace
}  // namespace slipwise
