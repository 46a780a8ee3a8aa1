// SPDX-License-Identifier: Apache-2.0
// The command actuator: what its steps sum to, causality, and its exact sensitivities.
// So hold its axes: axis_response, axis_stepper and the derivatives of first_order_lag.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "finite_difference.hpp"
#include "sample_drives.hpp"
#include "slipwise/actuator/actuator_model.hpp"

namespace slipwise {
namespace {

using Actuator = Eigen::Matrix<double, kActuatorParameters, 1>;

ActuatorModel actuator_of(const Eigen::VectorXd& p, double wheelbase = 0.0) {
  return {.time_constant_v = p[0],
          .time_constant_omega = p[1],
          .delay_v = p[2],
          .delay_omega = p[3],
          .clock_offset = p[4],
          .gain_v = p[5],
          .gain_omega = p[6],
          .slow_fraction_v = p[7],
          .slow_fraction_omega = p[8],
          .slow_time_constant_v = p[9],
          .slow_time_constant_omega = p[10],
          .wheelbase = wheelbase};
}

/// Totals of duration, forward, left, turn; and a moment that tells early steps from late ones.
Eigen::VectorXd totals(const ActuatorSteps& drive) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(7);
  double time = 0.0;
  for (const ActuatorStep& step : drive.steps) {
    const Eigen::Vector3d motion(step.forward, step.left, step.turn);
    const double middle = time + step.duration / 2.0;
    sum[0] += step.duration;
    sum.segment<3>(1) += motion;
    sum.tail<3>() += middle * motion;
    time += step.duration;
  }
  return sum;
}

Eigen::MatrixXd totals_jacobian(const ActuatorSteps& drive) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(7, kActuatorParameters);
  double time = 0.0;
  Eigen::RowVectorXd time_derivative = Eigen::RowVectorXd::Zero(kActuatorParameters);
  for (std::size_t k = 0; k < drive.steps.size(); ++k) {
    const ActuatorStep& step = drive.steps[k];
    const Eigen::Vector3d motion(step.forward, step.left, step.turn);
    const ActuatorStepJacobian& jacobian = drive.jacobians[k];
    sum.topRows<4>() += jacobian;
    sum.bottomRows<3>() += (time + step.duration / 2.0) * jacobian.bottomRows<3>();
    sum.bottomRows<3>() += motion * (time_derivative + jacobian.row(0) / 2.0);
    time += step.duration;
    time_derivative += jacobian.row(0);
  }
  return sum;
}

struct Case {
  std::string name;
  double period;
  ActuatorSpan window;
  Actuator parameters;
};

Actuator parameters(std::initializer_list<double> values) {
  Actuator actuator;
  std::ranges::copy(values, actuator.begin());
  return actuator;
}

/// Generic points: no input changes at a window's end, at its start, or together with one of the other channel.
std::vector<Case> sample_cases() {
  const Actuator lagging = parameters({0.31, 0.47, 0.113, 0.071, 0.023, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0});
  const Actuator shorter = parameters({0.11, 0.07, 0.2163, 0.1331, -0.0171, 0.9, 1.1, 0.0, 0.0, 0.0, 0.0});
  const Actuator slow = parameters({0.11, 0.27, 0.0163, 0.1331, 0.1171, 0.9, 1.1, 0.2, 0.4, 1.3, 2.1});
  const Actuator early = parameters({0.2, 0.3, 0.003, 0.004, -0.33, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0});
  const BodyTwist moving{0.6, 0.1, -0.3}, still{-0.2, -0.1, 0.4}, fast{1.9, 0.7, -1.3};
  const auto wheels =
      std::make_shared<const InputHistory>(tests::sampled(tests::sample_drives().front().twist, 0.003, 0.05, 200));
  const MeasuredActuator until_now{wheels, 2.013};
  return {
      {"20 Hz, measured start", 0.05, {.start = 2.013, .end = 4.487, .initial = moving}, lagging},
      {"20 Hz, warmed up", 0.05, {.start = 4.013, .end = 6.487}, lagging},
      {"20 Hz, late inputs clipped", 0.05, {.start = 2.013, .end = 4.487, .initial = moving}, shorter},
      {"20 Hz, clipped by a negative offset", 0.05, {.start = 4.013, .end = 6.487}, early},
      {"1 Hz held commands", 1.0137, {.start = 6.31, .end = 11.27, .initial = moving, .longest_step = 0.11}, lagging},
      {"1 Hz held commands, warmed up", 1.0137, {.start = 6.31, .end = 11.27, .longest_step = 0.11}, shorter},
      {"20 Hz, slow mode, measured start", 0.05, {.start = 2.013, .end = 4.487, .initial = moving}, slow},
      {"20 Hz, slow mode, far slower than its inputs", 0.05, {.start = 2.013, .end = 4.487, .initial = still}, slow},
      {"20 Hz, slow mode, far faster than its inputs", 0.05, {.start = 2.013, .end = 4.487, .initial = fast}, slow},
      {"20 Hz, slow mode, measured before any input acts", 0.05, {.start = 0.083, .end = 1.487, .initial = fast}, slow},
      {"20 Hz, slow mode, warmed up", 0.05, {.start = 4.013, .end = 6.487}, slow},
      {"20 Hz, known until after the start",
       0.05,
       {.start = 2.013, .end = 4.487, .initial = moving, .known = until_now},
       slow},
      {"20 Hz, known until the start, any inputs may follow",
       0.05,
       {.start = 2.013, .end = 4.487, .initial = fast, .known = MeasuredActuator{wheels, 2.013, true}},
       slow},
      {"20 Hz, known until before the start",
       0.05,
       {.start = 2.013, .end = 4.487, .initial = moving, .known = until_now},
       early},
      {"20 Hz, known throughout",
       0.05,
       {.start = 2.013, .end = 4.487, .initial = moving, .known = MeasuredActuator{wheels, 5.0}},
       slow},
  };
}

TEST_CASE("drive steps are linearised exactly by every parameter of the actuator") {
  for (const Case& c : sample_cases()) {
    for (const double wheelbase : {0.0, 0.4}) {
      CAPTURE(c.name);
      CAPTURE(wheelbase);
      const InputHistory inputs = tests::sampled(tests::sample_drives().back().twist, 0.0, c.period, 200);
      const auto value = [&](const Eigen::VectorXd& p) {
        return totals(actuator_steps(inputs, actuator_of(p, wheelbase), c.window));
      };
      const ActuatorSteps linearized = linearize_actuator_steps(inputs, actuator_of(c.parameters, wheelbase), c.window);
      CHECK((totals(linearized) - value(c.parameters)).norm() == 0.0);
      const auto numeric = tests::finite_difference(value, c.parameters, 5e-4);
      // Where there is no slow mode, its time constants cannot move: it would appear.
      const Eigen::Index moving = c.parameters.tail<2>().isZero() ? kActuatorParameters - 2 : kActuatorParameters;
      CHECK(tests::jacobian_error(totals_jacobian(linearized).leftCols(moving), numeric.leftCols(moving), 0.1) <
            tests::kDerivativeTolerance);
    }
  }
}

TEST_CASE(
    "without lag, gains scale distances, and delays and the clock offset move distances by the speeds at the ends") {
  const InputHistory inputs = tests::sampled(tests::sample_drives().front().twist, 0.0, 0.05, 200);
  const ActuatorSpan window{.start = 2.013, .end = 4.487};
  const auto value = [&](const Eigen::VectorXd& p) { return totals(actuator_steps(inputs, actuator_of(p), window)); };
  const Actuator point = parameters({0.0, 0.0, 0.113, 0.0717, 0.0231, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0});
  const auto linearized = linearize_actuator_steps(inputs, actuator_of(point), window);
  const auto moving_only = [&](const Eigen::VectorXd& p) {
    Actuator all = point;
    all.segment<5>(2) = p;
    return value(all);
  };
  const auto numeric = tests::finite_difference(moving_only, point.segment<5>(2), 1e-4);
  CHECK(tests::jacobian_error(totals_jacobian(linearized).middleCols<5>(2), numeric) < tests::kDerivativeTolerance);
  const double left_behind = inputs.at(2.013 - 0.0231 - 0.113).v - inputs.at(4.487 - 0.0231 - 0.113).v;
  CHECK(totals_jacobian(linearized)(1, 2) == doctest::Approx(left_behind).epsilon(1e-12));
}

TEST_CASE("without lag, a speed that was measured before any input acts is exact in gains, delays and clock offset") {
  const InputHistory inputs = tests::sampled(tests::sample_drives().back().twist, 0.0, 0.05, 200);
  const ActuatorSpan window{.start = 0.083, .end = 1.487, .initial = BodyTwist{1.9, 0.7, -1.3}};
  const Actuator point = parameters({0.0, 0.0, 0.2163, 0.1331, 0.0171, 0.9, 1.1, 0.0, 0.0, 0.0, 0.0});
  const auto value = [&](const Eigen::VectorXd& p) {
    Actuator all = point;
    all.segment<5>(2) = p;
    return totals(actuator_steps(inputs, actuator_of(all), window));
  };
  const auto linearized = linearize_actuator_steps(inputs, actuator_of(point), window);
  const auto numeric = tests::finite_difference(value, point.segment<5>(2), 1e-4);
  CHECK(tests::jacobian_error(totals_jacobian(linearized).middleCols<5>(2), numeric, 0.1) <
        tests::kDerivativeTolerance);
}

TEST_CASE("the identity actuator hands each held input on as it is") {
  const InputHistory inputs = tests::sampled(tests::sample_drives().front().twist, 0.0, 0.1, 50);
  const ActuatorSteps drive = actuator_steps(inputs, {}, {.start = 1.03, .end = 1.28});
  REQUIRE(drive.steps.size() == 3);
  CHECK(drive.jacobians.empty());
  const std::vector<double> durations{0.07, 0.1, 0.08};
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(drive.steps[i].duration == doctest::Approx(durations[i]).epsilon(1e-12));
    CHECK(drive.steps[i].forward == doctest::Approx(durations[i] * inputs.sample(10 + i).v).epsilon(1e-12));
    CHECK(drive.steps[i].turn == doctest::Approx(durations[i] * inputs.sample(10 + i).omega).epsilon(1e-12));
  }
}

TEST_CASE("drive steps cover the window without gap or overlap") {
  for (const Case& c : sample_cases()) {
    CAPTURE(c.name);
    const InputHistory inputs = tests::sampled(tests::sample_drives().front().twist, 0.0, c.period, 200);
    const double covered = totals(actuator_steps(inputs, actuator_of(c.parameters), c.window))[0];
    CHECK(covered == doctest::Approx(c.window.end - c.window.start).epsilon(1e-12));
  }
}

TEST_CASE("a lag's distance does not depend on how the window is divided") {
  const InputHistory inputs = tests::sampled(tests::sample_drives().front().twist, 0.0, 1.0, 20);
  const ActuatorModel actuator{.time_constant_v = 0.8, .time_constant_omega = 0.6, .delay_v = 0.16, .delay_omega = 0.2};
  const BodyTwist rest{};
  const auto fine = actuator_steps(inputs, actuator, {.start = 3.1, .end = 8.3, .initial = rest, .longest_step = 0.01});
  const auto coarse =
      actuator_steps(inputs, actuator, {.start = 3.1, .end = 8.3, .initial = rest, .longest_step = 5.0});
  CHECK(fine.steps.size() > 10 * coarse.steps.size());
  CHECK((totals(fine) - totals(coarse)).head<4>().norm() < 1e-11);
}

TEST_CASE("inputs later than the window's end are not used") {
  const auto until = [](std::size_t count) {
    return tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.05, count);
  };
  const ActuatorModel early{.clock_offset = -0.5};
  const ActuatorSpan window{.start = 1.02, .end = 2.02};
  const auto long_log = actuator_steps(until(200), early, window);
  const auto short_log = actuator_steps(until(41), early, window);  // the last input at 2.0 s
  REQUIRE(long_log.steps.size() == short_log.steps.size());
  CHECK((totals(long_log) - totals(short_log)).norm() == 0.0);
}

TEST_CASE("inputs ahead of the window's end drive what is stamped early") {
  const InputHistory inputs = tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.05, 200);
  const auto early = [&](double ahead) {
    return totals(
        actuator_steps(inputs, ActuatorModel{.clock_offset = -0.1}, {.start = 1.04, .end = 2.04, .ahead = ahead}));
  };
  const auto shifted = totals(actuator_steps(inputs, {}, {.start = 1.14, .end = 2.14}));
  CHECK((early(0.15) - shifted).norm() < 1e-12);
  CHECK((early(0.0) - shifted).norm() > 1e-4);
}

TEST_CASE("a robot that was measured at rest starts from rest") {
  const InputHistory inputs = tests::sampled(tests::sample_drives().front().twist, 0.0, 0.05, 200);
  const ActuatorModel actuator{.time_constant_v = 1e6, .time_constant_omega = 1e6};
  const auto drive = actuator_steps(inputs, actuator, {.start = 2.0, .end = 3.0, .initial = BodyTwist{}});
  CHECK(totals(drive).segment<3>(1).norm() < 1e-5);
}

TEST_CASE("a warmed-up lag forgets where it began") {
  const InputHistory whole = tests::sampled(tests::sample_drives().front().twist, 0.0, 0.05, 400);
  const ActuatorModel actuator{.time_constant_v = 0.4, .time_constant_omega = 0.5, .delay_v = 0.1, .delay_omega = 0.05};
  const auto from_rest = actuator_steps(whole, actuator, {.start = 0.0, .end = 15.0, .initial = BodyTwist{}});
  const auto until_ten = actuator_steps(whole, actuator, {.start = 0.0, .end = 10.0, .initial = BodyTwist{}});
  const auto warmed = actuator_steps(whole, actuator, {.start = 10.0, .end = 15.0});
  const Eigen::Vector3d last = (totals(from_rest) - totals(until_ten)).segment<3>(1);
  CHECK((totals(warmed).segment<3>(1) - last).norm() < 1e-3);
}

TEST_CASE("a slow mode with the lag's own time constant is that lag") {
  const InputHistory inputs = tests::sampled(tests::sample_drives().front().twist, 0.0, 0.05, 200);
  const ActuatorModel one{.time_constant_v = 0.8, .time_constant_omega = 0.6, .delay_v = 0.16};
  ActuatorModel two = one;
  two.slow_fraction_v = two.slow_fraction_omega = 0.4;
  two.slow_time_constant_v = 0.8;
  two.slow_time_constant_omega = 0.6;
  for (const std::optional<BodyTwist> initial : {std::optional<BodyTwist>{}, std::optional(BodyTwist{0.5, 0.0, 0.2})}) {
    const ActuatorSpan window{.start = 8.02, .end = 9.51, .initial = initial};
    CHECK((totals(actuator_steps(inputs, one, window)) - totals(actuator_steps(inputs, two, window))).norm() < 1e-9);
  }
}

TEST_CASE("a drive that is known throughout is what was measured") {
  const InputHistory commands = tests::sampled(tests::sample_drives().back().twist, 0.0, 0.05, 200);
  const auto wheels =
      std::make_shared<const InputHistory>(tests::sampled(tests::sample_drives().front().twist, 0.0, 0.05, 200));
  const ActuatorModel actuator{.time_constant_v = 0.3, .time_constant_omega = 0.2, .clock_offset = 0.11};
  const BodyTwist now = wheels->at(5.0);
  const auto known = actuator_steps(commands, actuator,
                                    {.start = 2.0, .end = 4.0, .initial = now, .known = MeasuredActuator{wheels, 5.0}});
  const auto measured = actuator_steps(*wheels, {.clock_offset = 0.11}, {.start = 2.0, .end = 4.0});
  CHECK((totals(known) - totals(measured)).norm() < 1e-12);
}

TEST_CASE("a drive goes on from where it was known, whatever the clock offset") {
  const InputHistory commands = tests::sampled(tests::sample_drives().back().twist, 0.0, 0.05, 101);  // until 5.0 s
  const auto wheels =
      std::make_shared<const InputHistory>(tests::sampled(tests::sample_drives().front().twist, 0.0, 0.05, 200));
  const double now = 3.02;
  for (const double offset : {0.13, -0.13}) {
    CAPTURE(offset);
    const ActuatorModel actuator{
        .time_constant_v = 0.3, .time_constant_omega = 0.2, .delay_v = 0.04, .clock_offset = offset};
    const auto whole = actuator_steps(
        commands, actuator,
        {.start = now, .end = now + 2.0, .initial = wheels->at(now), .known = MeasuredActuator{wheels, now}});
    ActuatorModel in_step = actuator;
    in_step.clock_offset = 0.0;
    const double end = now + 2.0 - offset;
    const auto after = actuator_steps(commands, in_step, {.start = now, .end = end, .initial = wheels->at(now)});
    Eigen::VectorXd expected = totals(after);
    if (offset > 0.0) {
      expected.head<4>() += totals(actuator_steps(*wheels, {}, {.start = now - offset, .end = now})).head<4>();
    } else {
      expected.head<4>() -=
          totals(actuator_steps(commands, in_step, {.start = now, .end = now - offset, .initial = wheels->at(now)}))
              .head<4>();
    }
    CHECK((totals(whole).head<4>() - expected.head<4>()).norm() < 1e-9);
  }
}

}  // namespace
}  // namespace slipwise
