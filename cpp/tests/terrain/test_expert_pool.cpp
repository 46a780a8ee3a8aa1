// SPDX-License-Identifier: Apache-2.0
// Two experts become one probability; doubt and newness speak for an unknown surface.
#include "slipwise/terrain/expert_pool.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

namespace slipwise {
namespace {

const Eigen::MatrixXd kSure = Eigen::RowVector2d(0.8, 0.2);
const Eigen::MatrixXd kEven = Eigen::RowVector2d(0.5, 0.5);

TEST_CASE("an expert who does not know changes nothing, and two who agree are surer") {
  const ExpertPool alone{.vibration = 1.0};
  const ExpertPool both{.vibration = 1.0, .current = 1.0};
  const double one = alone.pooled(kSure, kEven)(0, 0);
  CHECK(one == doctest::Approx(0.81 / 1.02));
  CHECK(both.pooled(kSure, kEven)(0, 0) == doctest::Approx(one));
  CHECK(both.pooled(kSure, kSure)(0, 0) > one);
}

TEST_CASE("an expert that is not asked may say nothing") {
  const Eigen::MatrixXd nothing = Eigen::MatrixXd::Constant(1, 2, std::numeric_limits<double>::quiet_NaN());
  CHECK(ExpertPool{.vibration = 1.0}.pooled(kSure, nothing).allFinite());
  CHECK_THROWS_AS((void)ExpertPool{}.pooled(kSure, Eigen::MatrixXd::Zero(2, 2)), std::invalid_argument);
}

TEST_CASE("doubt and newness raise the probability of unknown") {
  const ExpertPool pool{.offset = -1.0, .doubt = 0.5, .newness = 2.0};
  const double base = pool.unknown(kSure, Eigen::VectorXd::Zero(1))[0];
  CHECK(base == doctest::Approx(1.0 / (1.0 + std::exp(1.0 - 0.5 * std::log(0.25)))));
  CHECK(pool.unknown(kEven, Eigen::VectorXd::Zero(1))[0] > base);
  CHECK(pool.unknown(kSure, Eigen::VectorXd::Ones(1))[0] > base);
}

}  // namespace
}  // namespace slipwise
