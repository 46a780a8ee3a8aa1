// SPDX-License-Identifier: Apache-2.0
// One axis from a known state: the same as the whole actuator's walk, and its exact sensitivities.
#include "slipwise/actuator/axis_motion.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "finite_difference.hpp"
#include "slipwise/actuator/actuator_model.hpp"

namespace slipwise {
namespace {

const std::vector<double> kTimes{0.0, 0.3, 0.5, 0.9, 1.2, 1.6};
const std::vector<double> kSpeeds{0.4, 1.0, 1.0, -0.5, -0.2, 0.7};
const std::vector<double> kTurns{0.1, -0.6, 0.8, 0.8, 0.0, 0.3};
const std::vector<double> kStill(6, 0.0);
const std::vector<double> kEdges{0.45, 0.6, 0.77, 1.25, 1.4};

InputHistory commands() { return {kTimes, kSpeeds, kStill, kTurns}; }

ActuatorAxis axis_of(const Eigen::VectorXd& p) {
  return {&BodyTwist::omega,
          {.gain = p[2], .time_constant = p[0], .slow_fraction = p[3], .slow_time_constant = p[4]},
          p[1]};
}

TEST_CASE("an axis's means sum to what the whole actuator drives") {
  const ActuatorModel actuator{.time_constant_v = 0.2,
                               .time_constant_omega = 0.3,
                               .delay_v = 0.1,
                               .delay_omega = 0.13,
                               .gain_omega = 0.9,
                               .slow_fraction_omega = 0.3,
                               .slow_time_constant_omega = 0.8};
  const ActuatorAxis axis{&BodyTwist::omega, yaw_rate_response(actuator), actuator.delay_omega};
  const InputHistory inputs = commands();
  const double long_before = -20.0;
  const std::vector<double> all{long_before, 0.45, 0.6, 0.77, 1.25, 1.4};
  const AxisMotion motion = axis_motion(inputs, axis, settled_axis(inputs, axis, long_before), all);
  for (std::size_t k = 1; k + 1 < all.size(); ++k) {
    double turned = 0.0;
    for (const ActuatorStep& step : actuator_steps(inputs, actuator, {.start = all[k], .end = all[k + 1]}).steps) {
      turned += step.turn;
    }
    CHECK(motion.value[static_cast<Eigen::Index>(k)] * (all[k + 1] - all[k]) == doctest::Approx(turned).epsilon(1e-9));
  }
}

TEST_CASE("an axis that is followed in two stretches ends as in one") {
  const ActuatorAxis axis{
      &BodyTwist::v, {.gain = 1.1, .time_constant = 0.25, .slow_fraction = -0.2, .slow_time_constant = 1.5}, 0.08};
  const InputHistory inputs = commands();
  const AxisMotion whole = axis_motion(inputs, axis, {.fast = 0.2, .slow = -0.1}, kEdges);
  const AxisMotion first = axis_motion(inputs, axis, {.fast = 0.2, .slow = -0.1}, std::span(kEdges).first(3));
  const AxisMotion rest =
      axis_motion(inputs, axis, {.fast = first.value[2], .slow = first.value[3]}, std::span(kEdges).subspan(2));
  CHECK((whole.value.tail(4) - rest.value).lpNorm<Eigen::Infinity>() < 1e-14);
  CHECK((whole.value.head(2) - first.value.head(2)).lpNorm<Eigen::Infinity>() < 1e-14);
}

TEST_CASE("an axis's derivatives are its derivatives") {
  Eigen::VectorXd at(kAxisParameters);
  at << 0.3, 0.13, 0.9, 0.3, 0.8, 0.2, -0.1;
  const InputHistory inputs = commands();
  const auto motion = [&](const Eigen::VectorXd& p) {
    return axis_motion(inputs, axis_of(p), {.fast = p[5], .slow = p[6]}, kEdges);
  };
  const auto value = [&](const Eigen::VectorXd& p) -> Eigen::VectorXd { return motion(p).value; };
  const Eigen::MatrixXd numeric = tests::finite_difference(value, at, 0.01);
  CHECK(tests::jacobian_error(motion(at).derivative, numeric) < tests::kDerivativeTolerance);
}

}  // namespace
}  // namespace slipwise
