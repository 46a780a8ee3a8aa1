// SPDX-License-Identifier: Apache-2.0
// A kernel and trees of given numbers answer; numbers that do not fit are refused.
#include "slipwise/terrain/terrain_experts.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "terrain/sample_terrain.hpp"

namespace slipwise {
namespace {

TEST_CASE("a window is what the nearest centres are, and newer far from all") {
  const KernelExpert expert = tests::kernel(2);
  const Eigen::MatrixXd windows = (Eigen::MatrixXd(3, 2) << -1.0, 0.0, 1.0, 0.0, 9.0, 0.0).finished();
  const Eigen::MatrixXd found = expert.probabilities(windows);
  // five centres at distance 0 and five at squared distance 4, width 0.5, sharpness 4
  const double score = 4.0 * 5.0 * 0.1 * (1.0 - std::exp(-2.0));
  CHECK(found(0, 0) == doctest::Approx(1.0 / (1.0 + std::exp(-2.0 * score))));
  CHECK(found(1, 1) == doctest::Approx(found(0, 0)));
  const Eigen::VectorXd newness = expert.newness(windows);
  CHECK(newness[0] == doctest::Approx(std::log(1e-6)));
  CHECK(newness[2] == doctest::Approx(std::log(0.5 * 64.0 + 1e-6)));
}

TEST_CASE("trees are walked to their leaves and averaged") {
  TerrainTree second = tests::stump();
  second.threshold[0] = -1.0;
  const TreeExpert expert({tests::stump(), second}, 1);
  CHECK(expert.probabilities(Eigen::MatrixXd::Constant(1, 1, 0.5))(0, 0) == doctest::Approx(0.55));
  CHECK(expert.probabilities(Eigen::MatrixXd::Constant(1, 1, -2.0))(0, 0) == doctest::Approx(0.9));
}

TEST_CASE("numbers that lead nowhere are refused") {
  TerrainTree circle = tests::stump();
  circle.left[0] = 0;
  CHECK_THROWS_AS(TreeExpert({circle}, 1), std::invalid_argument);
  CHECK_THROWS_AS(TreeExpert({}, 1), std::invalid_argument);
  TerrainTree beside = tests::stump();
  beside.feature[0] = 1;
  CHECK_THROWS_AS(TreeExpert({beside}, 1), std::invalid_argument);
  CHECK_THROWS_AS(KernelExpert(Eigen::VectorXd::Zero(2), Eigen::VectorXd::Zero(2), 1.0, Eigen::MatrixXd::Zero(9, 2),
                               Eigen::MatrixXd::Zero(9, 2)),
                  std::invalid_argument);
  CHECK_THROWS_AS((void)tests::kernel(2).probabilities(Eigen::MatrixXd::Zero(1, 3)), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
