// SPDX-License-Identifier: Apache-2.0
// The held commands of a manoeuvre: they cover its length, bend as its curvature says, and know their derivatives.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>

#include "finite_difference.hpp"
#include "slipwise/planning/manoeuvre.hpp"

namespace slipwise {
namespace {

const ManoeuvreFrame kFrame{
    .speeds = {.start = 0.2, .cruise = 1.0, .end = 0.4}, .acceleration = 0.5, .direction = 1.0, .commands = 16};

ManoeuvreVector bent() {
  ManoeuvreVector parameters;
  parameters << 0.1, 0.4, -0.3, 0.6, 0.2, -0.5, 0.3, 3.0;
  return parameters;
}

TEST_CASE("the commands cover the length, forwards or backwards, and end at the end's speed") {
  for (const double direction : {1.0, -1.0}) {
    ManoeuvreFrame frame = kFrame;
    frame.direction = direction;
    const HeldCommands held = held_commands(frame, bent());
    REQUIRE(held.commands.size() == 17);
    double length = 0.0;
    for (std::size_t k = 0; k < held.end; ++k) {
      length += held.commands[k].v * held.period.value;
    }
    CHECK(length == doctest::Approx(direction * 3.0));
    CHECK(held.commands.back().v == direction * 0.4);
    CHECK(held.commands.back().omega == doctest::Approx(0.3 * direction * 0.4));
  }
}

TEST_CASE("a constant curvature is kept by every command") {
  ManoeuvreVector parameters = ManoeuvreVector::Constant(0.7);
  parameters[kLength] = 2.5;
  for (const HeldCommand& command : held_commands(kFrame, parameters).commands) {
    CHECK(command.omega == doctest::Approx(0.7 * command.v));
  }
}

TEST_CASE("period, speeds and yaw rates know their derivatives by the parameters") {
  const auto value = [](const Eigen::VectorXd& at) -> Eigen::VectorXd {
    const HeldCommands held = held_commands(kFrame, at);
    return Eigen::Vector4d(held.period.value, held.commands[3].v, held.commands[3].omega, held.commands[12].omega);
  };
  const HeldCommands held = held_commands(kFrame, bent());
  Eigen::MatrixXd derivatives = Eigen::MatrixXd::Zero(4, kManoeuvreParameters);
  derivatives(0, kLength) = held.period.derivative;
  derivatives(1, kLength) = held.commands[3].v_by_length;
  derivatives.row(2) = held.commands[3].omega_by;
  derivatives.row(3) = held.commands[12].omega_by;
  const Eigen::MatrixXd numeric = tests::finite_difference(value, bent(), 1e-2);
  CHECK(tests::jacobian_error(derivatives, numeric) < tests::kDerivativeTolerance);
}

TEST_CASE("commands without limits stay as they are; a top holds them and their derivatives") {
  const HeldCommands held = held_commands(kFrame, bent());
  CHECK(limited_commands(held, {}, {}).commands.size() == held.commands.size());
  const HeldCommands cut = limited_commands(held, {.speed = {.saturation = 0.6}}, {.v = 0.2});
  CHECK(cut.period.value == held.period.value);
  int held_down = 0;
  for (std::size_t k = 0; k < held.end; ++k) {
    const bool over = held.commands[k].v > 0.6;
    held_down += over ? 1 : 0;
    CHECK(cut.commands[k].v == (over ? 0.6 : held.commands[k].v));
    CHECK(cut.commands[k].v_by_length == (over ? 0.0 : held.commands[k].v_by_length));
  }
  CHECK(held_down > 3);
}

TEST_CASE("a manoeuvre behind ramps is cut in pieces and settles for as long as the last ramp takes") {
  ManoeuvreFrame stop = kFrame;
  stop.speeds = {.start = 0.0, .cruise = 1.0, .end = 0.0};
  stop.settling = 0.25;
  const CommandLimits limits{.speed = {.slew_rate_up = 5.0, .slew_rate_down = 0.25}};
  const HeldCommands held = held_commands(stop, bent());
  const HeldCommands ramped = limited_commands(held, limits, {});
  const auto pieces = static_cast<double>(ramped.end) / static_cast<double>(held.end);
  CHECK(pieces > 1.0);
  CHECK(ramped.period.value * pieces == doctest::Approx(held.period.value));
  CHECK(ramped.settling > 0.25 + 1.0);  // it brakes half as hard as it is commanded to
  CHECK(ramped.commands.back().v == doctest::Approx(0.0));
  double before = 0.0;
  for (const HeldCommand& command : ramped.commands) {
    CHECK(before - command.v <= 0.25 * ramped.period.value + 1e-12);
    before = command.v;
  }
}

}  // namespace
}  // namespace slipwise
