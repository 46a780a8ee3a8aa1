// SPDX-License-Identifier: Apache-2.0
// The layout of the parameter vector and the derivative of the chain's parameters.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "finite_difference.hpp"
#include "slipwise/motion/motion_model.hpp"

namespace slipwise {
namespace {

std::vector<std::string> names(const MotionModel& model) {
  std::vector<std::string> result;
  for (const ParameterInfo& info : model.parameters()) {
    result.push_back(info.name);
  }
  return result;
}

TEST_CASE("what is not learned is not a parameter") {
  const Basis basis = named_basis("edd-2");
  using Names = std::vector<std::string>;
  const Names chain{"log_lag_v", "log_lag_omega", "log_delay_v", "log_delay_omega"};
  CHECK(names(MotionModel(basis, {})) == Names{"lon.V", "ang.w"});
  CHECK(names(MotionModel(basis, {.clock_offset = true})) == Names{"lon.V", "ang.w", "clock_offset"});
  CHECK(names(MotionModel(basis, {.dynamics = true})) ==
        Names{"lon.V", "ang.w", chain[0], chain[1], chain[2], chain[3]});
  CHECK(names(MotionModel(basis, {.delays = true})) == Names{"lon.V", "ang.w", "delay_v", "delay_omega"});
  CHECK(names(MotionModel(basis, {.clock_offset = true, .mount = true})) ==
        Names{"lon.V", "ang.w", "clock_offset", "sensor_x", "sensor_y", "sensor_yaw"});
  CHECK(MotionModel(basis, {.dynamics = true, .clock_offset = true}).size() == 7);
  CHECK(MotionModel(basis, {.dynamics = true, .mount = true}).chain_size() == 4);
}

TEST_CASE("every parameter says its unit and meaning") {
  const MotionModel model(named_basis("thesis-15"),
                          {.dynamics = true, .clock_offset = true, .response = true, .mount = true});
  REQUIRE(model.parameters().size() == static_cast<std::size_t>(model.size()));
  for (const ParameterInfo& info : model.parameters()) {
    CHECK_FALSE(info.name.empty());
    CHECK_FALSE(info.unit.empty());
    CHECK_FALSE(info.description.empty());
  }
}

TEST_CASE("a chain that is not learned is the identity") {
  const MotionModel model(named_basis("edd-2"), {});
  const CommandChain chain = model.chain(Eigen::Vector2d(0.1, 0.2));
  CHECK(chain.lag_v == 0.0);
  CHECK(chain.delay_omega == 0.0);
  CHECK(chain.clock_offset == 0.0);
  CHECK(chain.gain_v == 1.0);
  CHECK(chain.slow_share_omega == 0.0);
}

TEST_CASE("delays alone are seconds, none and negative ones too, and nothing lags") {
  const MotionModel model(named_basis("edd-2"), {.delays = true});
  const CommandChain chain = model.chain(Eigen::Vector4d(0.1, 0.2, 0.0, -0.02));
  CHECK(chain.delay_v == 0.0);
  CHECK(chain.delay_omega == -0.02);
  CHECK(chain.lag_v == 0.0);
  CHECK(chain.lag_omega == 0.0);
}

TEST_CASE("delays alone and lags exclude each other") {
  CHECK_THROWS_WITH_AS(MotionModel(named_basis("edd-2"), {.dynamics = true, .delays = true}),
                       doctest::Contains("not both"), std::invalid_argument);
}

TEST_CASE("a sensor whose place is not learned sits at base_link") {
  const Eigen::Vector2d slip(0.1, 0.2);
  CHECK(MotionModel(named_basis("edd-2"), {}).mount(slip).vector().isZero(0.0));
  Eigen::VectorXd all(5);
  all << slip, 1.5, -0.2, 0.1;
  CHECK(MotionModel(named_basis("edd-2"), {.mount = true}).mount(all).vector() == Eigen::Vector3d(1.5, -0.2, 0.1));
}

TEST_CASE("places and scales are the derivative of the chain by the model's parameters") {
  for (const ChainParameters learned :
       {ChainParameters{true, true, true}, ChainParameters{true, true}, ChainParameters{true, false},
        ChainParameters{false, true}, ChainParameters{.delays = true},
        ChainParameters{.clock_offset = true, .delays = true}, ChainParameters{}}) {
    const MotionModel model(named_basis("edd-2"), learned);
    Eigen::VectorXd p = Eigen::VectorXd::LinSpaced(model.size(), -1.5, -0.4);
    const auto value = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
      const CommandChain c = model.chain(at);
      Eigen::VectorXd all(kChainParameters);
      all << c.lag_v, c.lag_omega, c.delay_v, c.delay_omega, c.clock_offset, c.gain_v, c.gain_omega, c.slow_share_v,
          c.slow_share_omega, c.slow_lag_v, c.slow_lag_omega;
      return all;
    };
    const Eigen::MatrixXd numeric = tests::finite_difference(value, p, 0.05);
    Eigen::MatrixXd analytic = Eigen::MatrixXd::Zero(kChainParameters, model.chain_size());
    const Eigen::VectorXd scales = model.chain_scales(model.chain(p));
    for (Eigen::Index i = 0; i < scales.size(); ++i) {
      analytic(model.chain_places()[static_cast<std::size_t>(i)], i) = scales[i];
    }
    CHECK(tests::jacobian_error(analytic, numeric.rightCols(analytic.cols())) < tests::kDerivativeTolerance);
  }
}

TEST_CASE("short times are even in seconds, long ones in their logarithm") {
  const MotionModel model(named_basis("edd-2"), {.dynamics = true, .clock_offset = true});
  Eigen::VectorXd p(7);
  p << 0.1, 0.2, std::log(0.06), std::log(0.12), std::log(30.0), std::log(1e-6), 0.4;
  const Eigen::VectorXd slopes = model.even_slopes(p);
  CHECK(slopes.head<2>() == Eigen::Vector2d::Ones());
  CHECK(slopes[2] == doctest::Approx(0.25));
  CHECK(slopes[3] == doctest::Approx(0.15 / 0.42));
  CHECK(slopes[4] == doctest::Approx(1.0).epsilon(0.01));
  CHECK(slopes[5] == doctest::Approx(0.1).epsilon(0.01));  // no time is so short that its logarithm does not count
  CHECK(slopes[6] == 1.0);
}

TEST_CASE("a parameter vector of the wrong size is refused with both sizes") {
  const MotionModel model(named_basis("edd-2"), {.clock_offset = true});
  CHECK_THROWS_WITH_AS(model.check(Eigen::Vector2d(0.0, 0.0)), doctest::Contains("takes 3 parameters, got 2"),
                       std::invalid_argument);
}

TEST_CASE("a parameter that is not finite is refused") {
  const MotionModel model(named_basis("edd-2"), {});
  const Eigen::Vector2d bad(0.0, std::numeric_limits<double>::quiet_NaN());
  CHECK_THROWS_WITH_AS(model.check(bad), doctest::Contains("not finite"), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
