// SPDX-License-Identifier: Apache-2.0
// The first-order lag: its exact step, its limits, and its derivatives.
#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <limits>

#include "finite_difference.hpp"
#include "slipwise/actuator/first_order_lag.hpp"

namespace slipwise {
namespace {

TEST_CASE("without a time constant the output is the input at once") {
  const LagStep step = linearize_lag_step(0.4, 2.0, 0.0, 0.5).value;
  CHECK(step.output == 2.0);
  CHECK(step.integral == 1.0);
}

TEST_CASE("a vanishing time constant has the limit of none, and finite derivatives") {
  for (const double time_constant : {1e-3, 1e-100, 1e-310}) {
    CAPTURE(time_constant);
    const auto step = linearize_lag_step(0.4, 2.0, time_constant, 0.5);
    CHECK(step.value.output == doctest::Approx(2.0));
    CHECK(step.value.integral == doctest::Approx(1.0).epsilon(1e-2));
    CHECK(std::isfinite(step.by_time_constant.output));
    CHECK(std::isfinite(step.by_time_constant.integral));
    CHECK(std::isfinite(step.by_duration.output));
  }
}

TEST_CASE("derivatives of a lag step are its derivatives by duration, output and time constant") {
  for (const double time_constant : {0.05, 0.8, 40.0}) {
    for (const double duration : {0.02, 0.3, 1.7}) {
      CAPTURE(time_constant);
      CAPTURE(duration);
      const auto at = [](const Eigen::VectorXd& p) -> Eigen::VectorXd {
        const LagStep step = linearize_lag_step(p[1], 1.4, p[2], p[0]).value;
        return Eigen::Vector2d(step.output, step.integral);
      };
      const Eigen::Vector3d point(duration, 0.3, time_constant);
      const auto step = linearize_lag_step(0.3, 1.4, time_constant, duration);
      Eigen::Matrix<double, 2, 3> analytic;
      analytic << step.by_duration.output, step.by_output.output, step.by_time_constant.output,
          step.by_duration.integral, step.by_output.integral, step.by_time_constant.integral;
      const auto numeric = tests::finite_difference(at, point, std::min(0.005, time_constant / 20.0));
      CHECK(tests::jacobian_error(analytic, numeric) < tests::kDerivativeTolerance);
    }
  }
}

}  // namespace
}  // namespace slipwise
