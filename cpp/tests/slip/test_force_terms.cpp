// SPDX-License-Identifier: Apache-2.0
// The terms of a force: which they are, and that wind turns with the map and not with the robot.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <stdexcept>

#include "finite_difference.hpp"
#include "slipwise/slip/force_terms.hpp"
#include "slipwise/slip/slip_surface.hpp"

namespace slipwise {
namespace {

SlipState headed(double v, double omega, double yaw) {
  return {.v = v, .omega = omega, .cos_yaw = std::cos(yaw), .sin_yaw = std::sin(yaw)};
}

/// Parameters of a basis that is nothing but a force: `ahead` and `left` in the frame that it is fixed to.
Eigen::VectorXd force_of(const Basis& basis, double ahead, double left) {
  Eigen::VectorXd alpha = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(basis.size()));
  for (const ForceTerm& term : force_terms(basis)) {
    const bool along_x = term.axis == ForceAxis::Ahead || term.axis == ForceAxis::WorldX;
    const bool along_y = term.axis == ForceAxis::Left || term.axis == ForceAxis::WorldY;
    alpha[term.place] = term.sign * (along_x ? ahead : (along_y ? left : 0.0));
  }
  return alpha;
}

TEST_CASE("a basis gets the terms of a force once") {
  const Basis slip = named_basis("ipem-9");  // has lon.abs(w) of its own
  const Basis body = with_force(slip, ForceFrame::Body);
  CHECK(body.name() == slip.name());
  CHECK(body.size() == slip.size() + 5);
  CHECK(force_terms(body).size() == 6);
  CHECK(with_force(body, ForceFrame::Body).size() == body.size());
  CHECK(with_force(slip, ForceFrame::World).size() == slip.size() + 8);
  CHECK(force_terms(named_basis("odd-even-10")).empty());
}

TEST_CASE("what a force does keeps its sign when the robot reverses, and is nothing at rest") {
  const Basis basis = with_force({"none", {}, {}, {}}, ForceFrame::Body);
  const Eigen::VectorXd alpha = force_of(basis, -0.02, 0.03);
  const Eigen::Vector3d forward = slip_rate(basis, alpha, headed(0.8, 0.3, 0.0));
  CHECK(forward.isApprox(slip_rate(basis, alpha, headed(-0.8, -0.3, 0.0))));
  CHECK(forward.x() == doctest::Approx(-0.02 * 1.1));
  CHECK(forward.y() == doctest::Approx(0.03 * 1.1));
  CHECK(slip_rate(basis, alpha, headed(0.0, 0.0, 0.7)).isZero(0.0));
}

TEST_CASE("wind pushes one way over the map, whatever the robot's heading") {
  const Basis basis = with_force({"none", {}, {}, {}}, ForceFrame::World);
  const Eigen::VectorXd alpha = force_of(basis, 0.04, -0.01);
  for (const double yaw : {0.0, 0.9, 2.5, -1.7}) {
    CAPTURE(yaw);
    const Eigen::Vector3d slip = slip_rate(basis, alpha, headed(1.0, 0.0, yaw));
    CHECK(std::cos(yaw) * slip.x() - std::sin(yaw) * slip.y() == doctest::Approx(0.04));
    CHECK(std::sin(yaw) * slip.x() + std::cos(yaw) * slip.y() == doctest::Approx(-0.01));
  }
}

TEST_CASE("slip has the exact slope by the heading") {
  const Basis basis = with_force(named_basis("drive-5"), ForceFrame::World);
  Eigen::VectorXd alpha(static_cast<Eigen::Index>(basis.size()));
  for (Eigen::Index i = 0; i < alpha.size(); ++i) {
    alpha[i] = 0.1 * std::sin(1.0 + static_cast<double>(i));
  }
  const auto of_yaw = [&](const Eigen::VectorXd& yaw) -> Eigen::VectorXd {
    return slip_rate(basis, alpha, headed(-0.7, 0.4, yaw[0]));
  };
  const Eigen::MatrixXd numeric = tests::finite_difference(of_yaw, Eigen::VectorXd::Constant(1, 0.6), 1e-2);
  CHECK(tests::jacobian_error(slip_rate_by_heading(basis, alpha, headed(-0.7, 0.4, 0.6)), numeric) <
        tests::kDerivativeTolerance);
}

TEST_CASE("a heading alone is no slip term: it would move a parked robot") {
  CHECK_THROWS_AS(Term::parse("cos(yaw)"), std::invalid_argument);
  CHECK(Term::parse("sin(yaw) * abs(V)").text() == "abs(V)*sin(yaw)");
  CHECK(Term::parse("abs(V)*sin(yaw)").by_heading());
  CHECK_FALSE(Term::parse("abs(V)").by_heading());
}

}  // namespace
}  // namespace slipwise
