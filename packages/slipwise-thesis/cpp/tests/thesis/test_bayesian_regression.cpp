// SPDX-License-Identifier: Apache-2.0
// Bayesian linear regression: batch solution, removal, sliding window, merge, and honest intervals.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "slipwise/thesis/bayesian_regression.hpp"

namespace slipwise {
namespace {

using Examples = std::vector<RegressionExample>;

const RegressionPrior kKnown{.weight_std = Eigen::Vector3d(2.0, 0.5, 1.0), .noise_std = 0.3};
const RegressionPrior kLearned{.weight_std = Eigen::Vector3d(2.0, 0.5, 1.0), .noise_std = 0.3, .noise_examples = 3.0};

Examples sample(unsigned seed, std::size_t count, double noise = 0.3) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const Eigen::Vector3d theta(0.8, -0.3, 0.5);
  Examples examples;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d x(normal(random), 3.0 * normal(random), normal(random));
    const double relative = i % 2 == 0 ? 1.0 : 1.5;
    examples.push_back({x, theta.dot(x) + noise * relative * normal(random), relative});
  }
  return examples;
}

BayesianRegression learned(const RegressionPrior& prior, const Examples& examples) {
  BayesianRegression regression(prior);
  for (const RegressionExample& example : examples) {
    regression.add(example);
  }
  return regression;
}

TEST_CASE("adding one by one equals batch least squares with a prior") {
  const Examples examples = sample(1, 40);
  const BayesianRegression regression = learned(kKnown, examples);
  Eigen::Matrix3d information = kKnown.weight_std.cwiseAbs2().cwiseInverse().asDiagonal();
  Eigen::Vector3d evidence = Eigen::Vector3d::Zero();
  for (const RegressionExample& e : examples) {
    const double variance = std::pow(kKnown.noise_std * e.relative_std, 2);
    information += e.features * e.features.transpose() / variance;
    evidence += e.features * e.output / variance;
  }
  CHECK(regression.information().isApprox(information, 1e-12));
  CHECK(regression.mean().isApprox(information.inverse() * evidence, 1e-11));
  CHECK(regression.covariance().isApprox(information.inverse(), 1e-11));
  const Eigen::Vector3d x(0.3, -1.0, 2.0);
  const RegressionPrediction at = regression.predict(x);
  CHECK(std::isinf(at.freedom));
  CHECK(at.std() * at.std() == doctest::Approx(x.dot(information.inverse() * x) + 0.09).epsilon(1e-11));
}

TEST_CASE("the learned noise is that of the normal-inverse-gamma formula in one piece") {
  const Examples examples = sample(2, 25);
  const BayesianRegression regression = learned(kLearned, examples);
  Eigen::Matrix3d information = (0.3 * kLearned.weight_std.cwiseInverse()).cwiseAbs2().asDiagonal();
  Eigen::Vector3d evidence = Eigen::Vector3d::Zero();
  double square = 0.0;
  for (const RegressionExample& e : examples) {
    const double variance = e.relative_std * e.relative_std;
    information += e.features * e.features.transpose() / variance;
    evidence += e.features * e.output / variance;
    square += e.output * e.output / variance;
  }
  const Eigen::Vector3d mean = information.inverse() * evidence;
  const double twice_b = 3.0 * 0.09 + square - mean.dot(evidence);
  CHECK(regression.noise_variance() == doctest::Approx(twice_b / (28.0 - 2.0)).epsilon(1e-10));
  CHECK(regression.freedom() == 28.0);
  const Eigen::Vector3d x(0.3, -1.0, 2.0);
  const double expected = std::sqrt(twice_b / 28.0 * (1.0 + x.dot(information.inverse() * x)));
  CHECK(regression.predict(x).scale == doctest::Approx(expected).epsilon(1e-10));
}

TEST_CASE("the Student-t interval holds as often as it says, and is wider than the noise alone") {
  // With 3 + 6 degrees of freedom, |t| < 2.2622 with probability 0.95. The truth is drawn from the prior.
  int inside = 0;
  const int runs = 4000;
  for (int run = 0; run < runs; ++run) {
    std::mt19937_64 random(1000U + static_cast<unsigned>(run));
    std::normal_distribution<double> normal;
    std::chi_squared_distribution<double> chi_square(3.0);
    const double noise = 0.3 * std::sqrt(3.0 / chi_square(random));
    Eigen::Vector3d theta;
    for (Eigen::Index i = 0; i < 3; ++i) {
      theta[i] = noise / 0.3 * kLearned.weight_std[i] * normal(random);
    }
    BayesianRegression regression(kLearned);
    const auto next = [&] {
      const Eigen::Vector3d x(normal(random), normal(random), normal(random));
      return RegressionExample{x, theta.dot(x) + noise * normal(random), 1.0};
    };
    for (int i = 0; i < 6; ++i) {
      regression.add(next());
    }
    const RegressionExample test = next();
    const RegressionPrediction at = regression.predict(test.features);
    inside += std::abs(test.output - at.mean) < 2.2622 * at.scale ? 1 : 0;
  }
  CHECK(inside / static_cast<double>(runs) == doctest::Approx(0.95).epsilon(0.011));  // three sigma of a fraction
}

TEST_CASE("wrong input is refused with what is wrong") {
  BayesianRegression regression(kKnown);
  CHECK_THROWS_AS(regression.add({Eigen::Vector2d(1.0, 2.0), 1.0, 1.0}), std::invalid_argument);
  CHECK_THROWS_AS(regression.add({Eigen::Vector3d(1.0, 2.0, std::nan("")), 1.0, 1.0}), std::invalid_argument);
  CHECK_THROWS_AS(regression.add({Eigen::Vector3d(1.0, 2.0, 3.0), 1.0, 0.0}), std::invalid_argument);
  CHECK_THROWS_AS(regression.predict(Eigen::VectorXd::Ones(2)), std::invalid_argument);
  CHECK_THROWS_AS(BayesianRegression({.weight_std = Eigen::Vector2d(1.0, 0.0)}), std::invalid_argument);
  CHECK_THROWS_AS(BayesianRegression({.weight_std = Eigen::VectorXd::Ones(1), .noise_examples = 0.0}),
                  std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
