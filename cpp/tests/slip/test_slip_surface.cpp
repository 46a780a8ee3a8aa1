// SPDX-License-Identifier: Apache-2.0
// Slip rates, their derivatives and their covariance, over all bases.
#include <doctest/doctest.h>

#include <vector>

#include "finite_difference.hpp"
#include "sample_bases.hpp"
#include "slipwise/slip/slip_surface.hpp"

namespace slipwise {
namespace {

std::vector<SlipState> sample_states() {
  return {{.v = 0.9, .omega = 0.5}, {.v = -1.2, .omega = 0.8, .gx = 0.3}, {.v = 0.4, .omega = -1.5, .gy = -0.6}};
}

TEST_CASE("derivatives of the slip rate are its derivatives by drive and by parameter") {
  for (const Basis& basis : tests::all_bases()) {
    CAPTURE(basis.name());
    const Eigen::VectorXd alpha = tests::sample_slip(basis, 6);
    for (const SlipState& state : sample_states()) {
      const auto linearized = linearize_slip_rate(basis, alpha, state);
      const auto by_drive = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
        return slip_rate(basis, alpha, {.v = d[0], .omega = d[1], .gx = state.gx, .gy = state.gy});
      };
      const auto by_parameter = [&](const Eigen::VectorXd& a) -> Eigen::VectorXd { return slip_rate(basis, a, state); };
      const auto actuator_derivatives = tests::finite_difference(by_drive, Eigen::Vector2d(state.v, state.omega), 0.01);
      const auto derivatives = tests::finite_difference(by_parameter, alpha, 0.1);
      CHECK((linearized.slip - slip_rate(basis, alpha, state)).norm() < 1e-14);
      CHECK(tests::jacobian_error(linearized.by_drive, actuator_derivatives) < tests::kDerivativeTolerance);
      CHECK(tests::jacobian_error(linearized.by_parameter, derivatives) < tests::kDerivativeTolerance);
    }
  }
}

TEST_CASE("the slip rate's covariance follows from that of the parameters") {
  const Basis basis = named_basis("edd-2");
  const Eigen::Matrix2d covariance = (Eigen::Matrix2d() << 0.04, 0.01, 0.01, 0.09).finished();
  const Eigen::Matrix3d slip = slip_rate_covariance(basis, covariance, {.v = 2.0, .omega = -0.5});
  CHECK(slip(0, 0) == doctest::Approx(0.16));
  CHECK(slip(2, 2) == doctest::Approx(0.0225));
  CHECK(slip(0, 2) == doctest::Approx(-0.01));
  CHECK(slip.row(1).isZero(0.0));
}

}  // namespace
}  // namespace slipwise
