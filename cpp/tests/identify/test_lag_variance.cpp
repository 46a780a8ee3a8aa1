// SPDX-License-Identifier: Apache-2.0
// A lag among candidates is as sure as their likelihoods say.
#include "slipwise/identify/lag_variance.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

namespace slipwise {
namespace {

constexpr std::array kLags{0.0, 0.1, 0.2, 0.4, 0.7};

/// Logarithms of the likelihoods where a lag is measured as `value` to `std` [s].
Eigen::VectorXd measured(double value, double std) {
  Eigen::VectorXd logarithm(5);
  for (Eigen::Index k = 0; k < 5; ++k) {
    logarithm[k] = -0.5 * std::pow((kLags[static_cast<std::size_t>(k)] - value) / std, 2.0);
  }
  return logarithm;
}

TEST_CASE("a lag is off by where the parabola has its top, and as sure as it is sharp") {
  CHECK(lag_variance(kLags, measured(0.2, 0.01), 2) == doctest::Approx(1e-4));
  CHECK(lag_variance(kLags, measured(0.23, 0.01), 2) == doctest::Approx(1e-4 + 9e-4));
}

TEST_CASE("without data any candidate may be it; at the ends the spacing says how sure") {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(5);
  CHECK(lag_variance(kLags, none, 0) > prior_lag_variance(kLags));
  CHECK(std::sqrt(lag_variance(kLags, measured(0.0, 0.001), 0)) == doctest::Approx(0.05 / std::sqrt(3.0)));
}

}  // namespace
}  // namespace slipwise
