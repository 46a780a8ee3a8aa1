// SPDX-License-Identifier: Apache-2.0
// Steady paths: their derivative, and the covariance of white slip noise and of an uncertain start.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <stdexcept>
#include <vector>

#include "finite_difference.hpp"
#include "slipwise/thesis/steady_segment.hpp"

namespace slipwise {
namespace {

const std::vector<double> kTimes{0.4, 1.1, 1.9, 3.0};

TEST_CASE("the derivative of a steady pose by its twist is that of differences") {
  for (const Eigen::Vector3d& twist : {Eigen::Vector3d(0.5, 0.02, 0.2), {0.0, 0.0, -1.4}, {-1.2, 0.1, 0.0}}) {
    const auto pose = [](const Eigen::VectorXd& at) -> Eigen::VectorXd {
      return steady_pose({.v = at[0], .vy = at[1], .omega = at[2]}, 2.3).vector();
    };
    const Eigen::Matrix3d analytic = steady_jacobian({.v = twist[0], .vy = twist[1], .omega = twist[2]}, 2.3);
    CHECK(tests::jacobian_error(analytic, tests::finite_difference(pose, twist, 0.1)) < tests::kDerivativeTolerance);
  }
}

TEST_CASE("on a straight line the covariance is that of the textbook, with dt counted once") {
  const double v = 2.0;
  const Eigen::MatrixXd s = steady_covariance({.v = v}, kTimes, {.psd = {0.1, 0.3, 0.2}, .start = {0.0, 0.0, 0.05}});
  const double t = 3.0;
  const double u = 1.1;
  CHECK(s(9, 9) == doctest::Approx(0.1 * t));
  CHECK(s(10, 10) == doctest::Approx(0.3 * t + 0.2 * v * v * t * t * t / 3.0 + 0.05 * v * v * t * t));
  CHECK(s(10, 11) == doctest::Approx(0.2 * v * t * t / 2.0 + 0.05 * v * t));
  CHECK(s(11, 11) == doctest::Approx(0.2 * t + 0.05));
  CHECK(s(3, 9) == doctest::Approx(0.1 * u));  // between times: the earlier one's
  CHECK(s(5, 10) == doctest::Approx(0.2 * v * (u * u / 2.0 + u * (t - u)) + 0.05 * v * t));
  CHECK((s - s.transpose()).isZero(1e-15));
}

TEST_CASE("on a circle the covariance does not depend on the times in between") {
  const SteadyNoise noise{.psd = {0.1, 0.2, 0.3}, .start = {0.01, 0.02, 0.03}};
  const BodyTwist twist{.v = 1.0, .vy = 0.1, .omega = 1.3};
  const std::vector<double> end{3.0};
  const Eigen::MatrixXd all = steady_covariance(twist, kTimes, noise);
  CHECK((all.bottomRightCorner<3, 3>() - steady_covariance(twist, end, noise)).norm() < 1e-7 * all.norm());
}

TEST_CASE("the noise of a measured pose is added at each time alone") {
  const Eigen::MatrixXd s = steady_covariance({.v = 1.0}, kTimes, {.pose = {1.0, 2.0, 3.0}});
  CHECK(s.isDiagonal());
  CHECK(s.diagonal().tail<3>().isApprox(Eigen::Vector3d(1.0, 2.0, 3.0)));
}

TEST_CASE("times that are not positive and increasing are refused") {
  for (const auto& times : std::vector<std::vector<double>>{{0.0, 1.0}, {1.0, 1.0}, {2.0, 1.0}}) {
    CHECK_THROWS_AS(steady_covariance_parts({}, times), std::invalid_argument);
  }
}

}  // namespace
}  // namespace slipwise
