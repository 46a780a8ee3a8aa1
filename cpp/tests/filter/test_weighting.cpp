// SPDX-License-Identifier: Apache-2.0
// Weights of candidates: they follow the scores, come back by the switching rate, and bad input is refused.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <stdexcept>

#include "slipwise/filter/weighting.hpp"

namespace slipwise {
namespace {

TEST_CASE("weights are tempered Bayes after a fraction is spread by the prior weights") {
  const Eigen::Vector2d prior(0.75, 0.25);
  const WeightingSettings settings{.learning_rate = 0.5, .fraction = 0.1};
  const Eigen::VectorXd weights =
      updated_weights(Eigen::Vector2d(0.2, 0.8), Eigen::Vector2d(1.0, -1.0), prior, settings, 0);
  const double first = 0.9 * 0.2 + 0.1 * 0.75, second = (0.9 * 0.8 + 0.1 * 0.25) * std::exp(-1.0);
  CHECK(weights[0] == doctest::Approx(first / (first + second)).epsilon(1e-12));
  CHECK(weights.sum() == doctest::Approx(1.0));
}

TEST_CASE("equal scores bring the weights back to the prior ones") {
  const Eigen::Vector2d prior(0.6, 0.4);
  Eigen::VectorXd weights = Eigen::Vector2d(1.0, 0.0);
  for (int i = 0; i < 200; ++i) {
    weights = updated_weights(weights, Eigen::Vector2d::Zero(), prior, {}, 0);
  }
  CHECK(weights.isApprox(prior, 1e-4));
}

TEST_CASE(
    "the fraction falls with the segments observed, so that one that leads for long keeps nearly all the weight") {
  const Eigen::Vector2d prior(0.5, 0.5), leading(1.0, 0.0), equal = Eigen::Vector2d::Zero();
  const WeightingSettings settings{.learning_rate = 1.0, .fraction = 0.1};
  CHECK(updated_weights(leading, equal, prior, settings, 3)[1] == doctest::Approx(0.05));
  CHECK(updated_weights(leading, equal, prior, settings, 199)[1] == doctest::Approx(0.0025));
}

TEST_CASE("candidates are judged by their errors under one covariance, whatever they say of themselves") {
  const std::array<Rows, 2> errors{Eigen::Vector3d(0.1, 0.0, 0.0), Eigen::Vector3d(0.2, 0.0, 0.0)};
  const Eigen::Matrix3d unit = Eigen::Matrix3d::Identity();
  const std::array<RowsCovariance, 2> sizes{100.0 * unit, 0.01 * unit};
  const Eigen::VectorXd scores = common_log_scores(Eigen::Vector2d(0.5, 0.5), errors, sizes);
  CHECK(scores[0] > scores[1]);
  const Eigen::Matrix3d mean = 50.005 * unit;
  CHECK(scores[0] == doctest::Approx(student_log_score(0.01 / 50.005, mean)).epsilon(1e-12));
}

TEST_CASE("a small error scores higher than a large one, and less steeply than a normal density far out") {
  const Eigen::Matrix3d unit = Eigen::Matrix3d::Identity();
  CHECK(student_log_score(1.0, unit) > student_log_score(9.0, unit));
  CHECK(student_log_score(100.0, unit) - student_log_score(200.0, unit) < 50.0);
  CHECK(student_log_score(1.0, unit) > student_log_score(1.0, 4.0 * unit));
}

TEST_CASE("what does not fit together is refused") {
  const Eigen::Vector2d two(0.5, 0.5);
  CHECK_THROWS_AS(updated_weights(two, Eigen::Vector3d::Zero(), two, {}, 0), std::invalid_argument);
  CHECK_THROWS_AS(updated_weights(two, two, Eigen::Vector3d::Zero(), {}, 0), std::invalid_argument);
  CHECK_THROWS_AS(updated_weights({}, {}, {}, {}, 0), std::invalid_argument);
  const std::array<Rows, 1> one{};
  const std::array<RowsCovariance, 2> sizes{};
  CHECK_THROWS_AS(common_log_scores(two, one, sizes), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
