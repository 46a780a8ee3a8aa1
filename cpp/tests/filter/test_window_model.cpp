// SPDX-License-Identifier: Apache-2.0
// Conditioning on a model: where all is linear, the same as conditioning the joint normal distribution.
#include "slipwise/filter/window_model.hpp"

#include <doctest/doctest.h>
#include <Eigen/LU>

#include <cmath>

namespace slipwise {
namespace {

WindowModel linear(const Eigen::VectorXd& state) {
  WindowModel model{.measured = 2,
                    .value = Eigen::VectorXd::Zero(4),
                    .derivative = Eigen::MatrixXd(4, 2),
                    .noise = Eigen::MatrixXd(4, 4)};
  model.derivative << 1.0, 0.5, -0.3, 2.0, 0.9, 0.1, 0.0, 0.7;
  model.value = model.derivative * state;
  Eigen::MatrixXd root(4, 4);
  root << 0.3, 0.0, 0.0, 0.0, 0.1, 0.2, 0.0, 0.0, 0.2, 0.1, 0.1, 0.0, 0.0, 0.3, 0.1, 0.2;
  model.noise = root * root.transpose();
  return model;
}

Estimate prior() {
  Eigen::MatrixXd covariance(2, 2);
  covariance << 0.5, 0.2, 0.2, 0.4;
  return {Eigen::Vector2d(0.3, -0.2), covariance};
}

TEST_CASE("the end given what was measured is that of the joint distribution") {
  const Eigen::Vector2d measured(1.1, 0.4);
  const WindowPoint point = most_probable_start(prior(), linear(prior().mean), linear, measured, {});
  const Estimate end = end_estimate(prior(), point, measured);
  const WindowModel at = linear(prior().mean);
  const Eigen::MatrixXd joint = at.derivative * prior().covariance * at.derivative.transpose() + at.noise;
  const Eigen::MatrixXd gain = joint.bottomLeftCorner(2, 2) * Eigen::Matrix2d(joint.topLeftCorner(2, 2)).inverse();
  const Eigen::VectorXd mean = at.value.tail(2) + gain * (measured - at.value.head(2));
  CHECK((end.mean - mean).norm() < 1e-12);
  CHECK((end.covariance - (joint.bottomRightCorner(2, 2) - gain * joint.topRightCorner(2, 2))).norm() < 1e-12);
}

TEST_CASE("a model that is not linear settles where its cost is least") {
  const auto bent = [](const Eigen::VectorXd& state) {
    WindowModel model{.measured = 1,
                      .value = Eigen::Vector2d(std::exp(state[0]), state[0]),
                      .derivative = Eigen::Vector2d(std::exp(state[0]), 1.0),
                      .noise = Eigen::Matrix2d::Zero()};
    model.noise(0, 0) = 0.01;
    return model;
  };
  const Estimate before{Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Identity(1, 1)};
  const Eigen::VectorXd measured = Eigen::VectorXd::Constant(1, 3.0);
  const double found =
      most_probable_start(before, bent(before.mean), bent, measured, {.iterations = 20, .tolerance = 1e-12}).state[0];
  const double derivative = found + (std::exp(found) - 3.0) * std::exp(found) / 0.01;
  CHECK(std::abs(derivative) < 1e-3);
}

}  // namespace
}  // namespace slipwise
