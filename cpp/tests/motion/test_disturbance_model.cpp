// SPDX-License-Identifier: Apache-2.0
// The slip disturbance: which terms do, how far their mean over some time is from what was learned, and bad laws.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "slipwise/motion/disturbance_model.hpp"

namespace slipwise {
namespace {

TEST_CASE("the fractions of V and of w are disturbed, each by a fraction of its own prior") {
  const MotionModel model(named_basis("full-linear-6"), {.dynamics = true});
  const Eigen::VectorXd prior_std = Eigen::VectorXd::LinSpaced(model.size(), 0.1, 1.0);
  const DisturbedTerms terms = disturbed_terms(model, prior_std);
  REQUIRE(terms.size() == kMostDisturbed);
  const Eigen::VectorXd variances = terms.variances({0.5, 2.0, 7.0});
  for (Eigen::Index i = 0; i < terms.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const std::string name = model.basis().parameter_name(static_cast<std::size_t>(terms.places[k]));
    CAPTURE(name);
    CHECK(terms.of_turn[k] == name.ends_with(".w"));
    const bool angular = terms.channels[k] == Channel::Ang;
    CHECK(angular == name.starts_with("ang"));
    CHECK(std::sqrt(variances[i]) == doctest::Approx((angular ? 2.0 : 0.5) * prior_std[terms.places[k]]));
  }
  CHECK_THROWS_AS(disturbed_terms(model, prior_std.head(3)), std::invalid_argument);
}

TEST_CASE("the mean of a process over some time has the variance of simulated ones, and is smooth where it is short") {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  constexpr int kDraws = 4000, kSteps = 100;
  for (const double spans : {0.2, 1.0, 5.0}) {
    const double kept = std::exp(-spans / kSteps);
    double squares = 0.0, products = 0.0;
    for (int draw = 0; draw < kDraws; ++draw) {
      double value = normal(random), mean = 0.0;
      const double first = value;
      for (int step = 0; step < kSteps; ++step) {
        mean += value / kSteps;
        value = kept * value + std::sqrt(1.0 - kept * kept) * normal(random);
      }
      squares += mean * mean / kDraws;
      products += mean * first / kDraws;
    }
    CHECK(variance_over(spans) == doctest::Approx(squares).epsilon(4.0 * std::sqrt(2.0 / kDraws) + 0.02));
    CHECK(kept_over(spans) == doctest::Approx(products).epsilon(0.1));
  }
  CHECK(variance_over(0.0) == 1.0);
  CHECK(kept_over(0.0) == 1.0);
  CHECK(variance_over(0.999e-3) == doctest::Approx(variance_over(1.001e-3)).epsilon(1e-6));
}

TEST_CASE("slip differs for as long as usual, until longer is likelier") {
  const auto time = [](double none, double shorter, double longer) {
    const DisturbanceModel law{{{0.0, 0.0, 30.0}, {0.1, 0.0, 5.0}, {0.0, 0.2, 20.0}},
                               Eigen::Vector3d(none, shorter, longer)};
    return correlation_time(law, 8.0);
  };
  CHECK(time(0.6, 0.4, 0.0) == 8.0);
  CHECK(time(0.1, 0.15, 0.75) == 8.0);
  CHECK(time(0.1, 0.025, 0.875) == doctest::Approx(14.0));
  CHECK(time(0.0, 0.0, 1.0) == doctest::Approx(20.0));
  CHECK(correlation_time({}, 8.0) == 8.0);
}

TEST_CASE("the slip disturbance widens the parameters' covariance less over a longer time, and not without a law") {
  const MotionModel model(named_basis("edd-2"), {});
  const Eigen::VectorXd prior_std = Eigen::Vector2d(0.3, 0.4);
  const Eigen::MatrixXd learned = 1e-4 * Eigen::Matrix2d::Identity();
  const DisturbanceModel law{{{0.0, 0.0, 1.0}, {0.1, 0.2, 5.0}}, Eigen::Vector2d(0.25, 0.75)};
  const auto over = [&](double seconds) { return covariance_over(model, learned, law, prior_std, seconds); };
  CHECK(over(0.0)(0, 0) == doctest::Approx(1e-4 + 0.75 * 0.03 * 0.03));
  CHECK(over(0.0)(1, 1) == doctest::Approx(1e-4 + 0.75 * 0.08 * 0.08));
  CHECK(over(0.0)(0, 1) == 0.0);
  CHECK(over(10.0)(1, 1) < over(1.0)(1, 1));
  CHECK(covariance_over(model, learned, {}, prior_std, 1.0) == learned);
}

TEST_CASE("a law whose numbers contradict each other is refused") {
  const SlipDisturbance one{0.1, 0.0, 5.0};
  CHECK_NOTHROW(check_disturbance({}));
  CHECK_NOTHROW(check_disturbance({{one}, Eigen::VectorXd::Ones(1)}));
  CHECK_THROWS_AS(check_disturbance({{one}, {}}), std::invalid_argument);
  CHECK_THROWS_AS(check_disturbance({{one}, Eigen::VectorXd::Constant(1, 0.5)}), std::invalid_argument);
  CHECK_THROWS_AS(check_disturbance({{{0.1, 0.0, 0.0}}, Eigen::VectorXd::Ones(1)}), std::invalid_argument);
  CHECK_THROWS_AS(check_disturbance({{{-0.1, 0.0, 5.0}}, Eigen::VectorXd::Ones(1)}), std::invalid_argument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(check_disturbance({{{0.1, nan, 5.0}}, Eigen::VectorXd::Ones(1)}), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
