// SPDX-License-Identifier: Apache-2.0
// The layout of the parameter vector and the derivative of the actuator's parameters.
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
  const Names actuator{"log_time_constant_v", "log_time_constant_omega", "log_delay_v", "log_delay_omega"};
  CHECK(names(MotionModel(basis, {})) == Names{"lon.V", "ang.w"});
  CHECK(names(MotionModel(basis, {.clock_offset = true})) == Names{"lon.V", "ang.w", "clock_offset"});
  CHECK(names(MotionModel(basis, {.dynamics = true})) ==
        Names{"lon.V", "ang.w", actuator[0], actuator[1], actuator[2], actuator[3]});
  CHECK(names(MotionModel(basis, {.delays = true})) == Names{"lon.V", "ang.w", "delay_v", "delay_omega"});
  CHECK(names(MotionModel(basis, {.clock_offset = true, .sensor_extrinsics = true})) ==
        Names{"lon.V", "ang.w", "clock_offset", "sensor_x", "sensor_y", "sensor_yaw"});
  CHECK(MotionModel(basis, {.dynamics = true, .clock_offset = true}).size() == 7);
  CHECK(MotionModel(basis, {.dynamics = true, .sensor_extrinsics = true}).actuator_size() == 4);
}

TEST_CASE("every parameter says its unit and meaning") {
  const MotionModel model(named_basis("thesis-15"),
                          {.dynamics = true, .clock_offset = true, .response = true, .sensor_extrinsics = true});
  REQUIRE(model.parameters().size() == static_cast<std::size_t>(model.size()));
  for (const ParameterInfo& info : model.parameters()) {
    CHECK_FALSE(info.name.empty());
    CHECK_FALSE(info.unit.empty());
    CHECK_FALSE(info.description.empty());
  }
}

TEST_CASE("an actuator that is not learned is the identity") {
  const MotionModel model(named_basis("edd-2"), {});
  const ActuatorModel actuator = model.actuator(Eigen::Vector2d(0.1, 0.2));
  CHECK(actuator.time_constant_v == 0.0);
  CHECK(actuator.delay_omega == 0.0);
  CHECK(actuator.clock_offset == 0.0);
  CHECK(actuator.gain_v == 1.0);
  CHECK(actuator.slow_fraction_omega == 0.0);
}

TEST_CASE("delays alone are seconds, none and negative ones too, and nothing lags") {
  const MotionModel model(named_basis("edd-2"), {.delays = true});
  const ActuatorModel actuator = model.actuator(Eigen::Vector4d(0.1, 0.2, 0.0, -0.02));
  CHECK(actuator.delay_v == 0.0);
  CHECK(actuator.delay_omega == -0.02);
  CHECK(actuator.time_constant_v == 0.0);
  CHECK(actuator.time_constant_omega == 0.0);
}

TEST_CASE("delays alone and lags exclude each other") {
  CHECK_THROWS_WITH_AS(MotionModel(named_basis("edd-2"), {.dynamics = true, .delays = true}),
                       doctest::Contains("not both"), std::invalid_argument);
  CHECK_THROWS_AS(MotionModel(named_basis("edd-2"), {.delays = true, .lags = true}), std::invalid_argument);
  CHECK_THROWS_AS(MotionModel(named_basis("edd-2"), {.dynamics = true, .lags = true}), std::invalid_argument);
}

TEST_CASE("a body that lags behind its wheels goes on as it did where a log begins in motion") {
  const MotionModel model(named_basis("edd-2"), {.lags = true});
  const ActuatorModel actuator = model.actuator(Eigen::Vector4d::Constant(std::log(0.4)));
  const InputHistory wheels(std::vector{0.0}, std::vector{BodyTwist{.v = 1.0, .omega = 0.5}});
  const ActuatorSteps driven = actuator_steps(wheels, actuator, {.start = 0.0, .end = 2.0});
  double forward = 0.0, turn = 0.0;
  for (const ActuatorStep& step : driven.steps) {
    forward += step.forward;
    turn += step.turn;
  }
  CHECK(forward == doctest::Approx(2.0));
  CHECK(turn == doctest::Approx(1.0));
}

TEST_CASE("a sensor whose place is not learned sits at base_link") {
  const Eigen::Vector2d slip(0.1, 0.2);
  CHECK(MotionModel(named_basis("edd-2"), {}).sensor_extrinsics(slip).vector().isZero(0.0));
  Eigen::VectorXd all(5);
  all << slip, 1.5, -0.2, 0.1;
  CHECK(MotionModel(named_basis("edd-2"), {.sensor_extrinsics = true}).sensor_extrinsics(all).vector() ==
        Eigen::Vector3d(1.5, -0.2, 0.1));
}

TEST_CASE("places and scales are the derivative of the actuator by the model's parameters") {
  for (const ActuatorParameters learned :
       {ActuatorParameters{true, true, true}, ActuatorParameters{true, true}, ActuatorParameters{true, false},
        ActuatorParameters{false, true}, ActuatorParameters{.delays = true},
        ActuatorParameters{.clock_offset = true, .delays = true}, ActuatorParameters{}}) {
    const MotionModel model(named_basis("edd-2"), learned);
    Eigen::VectorXd p = Eigen::VectorXd::LinSpaced(model.size(), -1.5, -0.4);
    const auto value = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
      const ActuatorModel c = model.actuator(at);
      Eigen::VectorXd all(kActuatorParameters);
      all << c.time_constant_v, c.time_constant_omega, c.delay_v, c.delay_omega, c.clock_offset, c.gain_v, c.gain_omega,
          c.slow_fraction_v, c.slow_fraction_omega, c.slow_time_constant_v, c.slow_time_constant_omega;
      return all;
    };
    const Eigen::MatrixXd numeric = tests::finite_difference(value, p, 0.05);
    Eigen::MatrixXd analytic = Eigen::MatrixXd::Zero(kActuatorParameters, model.actuator_size());
    const Eigen::VectorXd scales = model.actuator_scales(model.actuator(p));
    for (Eigen::Index i = 0; i < scales.size(); ++i) {
      analytic(model.actuator_places()[static_cast<std::size_t>(i)], i) = scales[i];
    }
    CHECK(tests::jacobian_error(analytic, numeric.rightCols(analytic.cols())) < tests::kDerivativeTolerance);
  }
}

TEST_CASE("short times are even in seconds, long ones in their logarithm") {
  const MotionModel model(named_basis("edd-2"), {.dynamics = true, .clock_offset = true});
  Eigen::VectorXd p(7);
  p << 0.1, 0.2, std::log(0.06), std::log(0.12), std::log(30.0), std::log(1e-6), 0.4;
  const Eigen::VectorXd derivatives = model.log_time_derivatives(p);
  CHECK(derivatives.head<2>() == Eigen::Vector2d::Ones());
  CHECK(derivatives[2] == doctest::Approx(0.25));
  CHECK(derivatives[3] == doctest::Approx(0.15 / 0.42));
  CHECK(derivatives[4] == doctest::Approx(1.0).epsilon(0.01));
  CHECK(derivatives[5] == doctest::Approx(0.1).epsilon(0.01));  // no time is so short that its logarithm does not count
  CHECK(derivatives[6] == 1.0);
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
