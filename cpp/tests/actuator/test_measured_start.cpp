// SPDX-License-Identifier: Apache-2.0
// From a measured speed a constant command carries the drive to its own speed, and not beyond.
#include "slipwise/actuator/measured_start.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "slipwise/actuator/command_limits.hpp"

namespace slipwise {
namespace {

constexpr double kPeriod = 0.05;  // [s]
constexpr CommandLimits kRamps{.speed = {.slew_rate_up = 0.8, .slew_rate_down = 1.7},
                               .yaw_rate = {.slew_rate_up = 1.3, .slew_rate_down = 0.9}};

struct Point {
  double time_constant, slow_time_constant, fraction, gain, delay;
  double sent;  ///< before the start [s]
  double part;  ///< of the command's speed, measured
  double command;
};

ActuatorModel actuator_of(const Point& at) {
  return {.time_constant_v = at.time_constant,
          .time_constant_omega = at.time_constant,
          .delay_v = at.delay,
          .delay_omega = at.delay,
          .gain_v = at.gain,
          .gain_omega = at.gain,
          .slow_fraction_v = at.fraction,
          .slow_fraction_omega = at.fraction,
          .slow_time_constant_v = at.slow_time_constant,
          .slow_time_constant_omega = at.slow_time_constant};
}

InputHistory held(const Point& at) {
  std::vector<double> t;
  std::vector<BodyTwist> twist;
  for (double now = 0.0; now < at.sent + 4.0; now += kPeriod) {
    t.push_back(now);
    twist.push_back({at.command, 0.0, 0.5 * at.command});
  }
  return {t, twist};
}

std::string text_of(const Point& at) {
  std::string text;
  for (const double value : {at.slow_time_constant, at.fraction, at.delay, at.sent, at.part, at.command}) {
    text += std::to_string(value) + " ";
  }
  return text;
}

template <typename Check>
void for_all_points(const Check& check) {
  for (const double slow_time_constant : {0.5, 1.5, 6.0}) {
    for (const double fraction : {0.0, 0.14, 0.5, 1.0}) {
      for (const double delay : {0.0, 0.13, 0.4}) {
        for (const double sent : {0.0, 0.05, 0.31, 0.9}) {
          for (const double part : {0.0, 0.2, 0.7, 1.0}) {
            for (const double command : {1.0, -0.6}) {
              check(Point{0.3 * slow_time_constant, slow_time_constant, fraction, 0.8, delay, sent, part, command});
            }
          }
        }
      }
    }
  }
}

/// Speeds of the drive over the steps after the start.
void check_law(const Point& at, const InputHistory& inputs, double tolerance) {
  const double goal = at.gain * at.command;
  const BodyTwist measured{at.part * goal, 0.0, 0.5 * at.part * goal};
  const auto drive =
      actuator_steps(inputs, actuator_of(at), {.start = at.sent, .end = at.sent + 3.0, .initial = measured});
  for (const ActuatorStep& step : drive.steps) {
    if (step.duration < 1e-9) {
      continue;
    }
    const double v = step.forward / step.duration, omega = 2.0 * step.turn / step.duration;
    for (const double speed : {v, omega}) {
      REQUIRE(speed >= std::min(0.0, goal) - 1e-9);
      REQUIRE(speed <= std::max(0.0, goal) + 1e-9);
      if (at.part == 1.0) {
        REQUIRE(speed == doctest::Approx(goal).epsilon(tolerance));
      }
    }
  }
}

TEST_CASE("under a constant command the speed stays between rest and the command's, and where it is there it stays") {
  for_all_points([](const Point& at) {
    CAPTURE(text_of(at));
    check_law(at, held(at), 1e-9);
  });
}

/// Commands that change every 0.4 s, within 0.3 and 0.9 of the point's, that held the first for long before.
InputHistory changing(const Point& at) {
  std::vector<double> t{-100.0};
  std::vector<BodyTwist> twist{{0.3 * at.command, 0.0, 0.15 * at.command}};
  for (int i = 0; 0.4 * i < at.sent + 4.0; ++i) {
    const double part = 0.3 + 0.15 * ((7 * i + 3) % 5);
    t.push_back(0.4 * i);
    twist.push_back({part * at.command, 0.0, 0.5 * part * at.command});
  }
  return {t, twist};
}

TEST_CASE("where any commands may follow, the speed stays between the measured one and those they lead to") {
  for_all_points([](const Point& at) {
    CAPTURE(text_of(at));
    const double goal = at.gain * at.command, low = std::min(0.3, at.part), high = std::max(0.9, at.part);
    const BodyTwist measured{at.part * goal, 0.0, 0.5 * at.part * goal};
    const auto twist = std::make_shared<const InputHistory>(std::vector{-100.0}, std::vector{measured});
    const auto drive =
        actuator_steps(changing(at), actuator_of(at),
                       {.start = at.sent,
                        .end = at.sent + 3.0,
                        .initial = measured,
                        .known = MeasuredActuator{.twist = twist, .until = at.sent, .any_inputs = true}});
    for (const ActuatorStep& step : drive.steps) {
      if (step.duration >= 1e-9) {
        for (const double part : {step.forward / step.duration / goal, 2.0 * step.turn / step.duration / goal}) {
          REQUIRE(part >= low - 1e-9);
          REQUIRE(part <= high + 1e-9);
        }
      }
    }
  });
}

TEST_CASE("so it does behind limits that ramp") {
  for_all_points([](const Point& at) {
    CAPTURE(text_of(at));
    const double goal = at.part * at.gain * at.command;
    const MeasuredStart start = measured_start(actuator_of(at), at.sent, {goal, 0.0, 0.5 * goal});
    check_law(at, limited_inputs(held(at), kRamps, start), 1e-9);
  });
}

TEST_CASE("a measured speed that the commands explain changes nothing") {
  const Point at{0.3, 1.5, 0.4, 0.8, 0.13, 0.0, 0.0, 1.0};
  const InputHistory inputs(std::vector{0.0, 2.0, 3.1, 3.4},
                            std::vector{BodyTwist{1.0, 0.0, 0.4}, BodyTwist{0.0, 0.0, -0.4}, BodyTwist{0.6, 0.0, 0.1},
                                        BodyTwist{0.5, 0.0, 0.2}});
  const ActuatorModel actuator = actuator_of(at);
  constexpr double kMoment = 1e-6;
  for (const double start : {0.05, 0.9, 2.4, 3.2, 3.8}) {
    CAPTURE(start);
    const ActuatorStep moment = actuator_steps(inputs, actuator, {.start = start - kMoment, .end = start}).steps.back();
    const BodyTwist now{moment.forward / moment.duration, 0.0, moment.turn / moment.duration};
    const auto sum = [&](const ActuatorSpan& window) {
      double forward = 0.0;
      for (const ActuatorStep& step : actuator_steps(inputs, actuator, window).steps) {
        forward += step.forward;
      }
      return forward;
    };
    CHECK(sum({.start = start, .end = start + 2.0, .initial = now}) ==
          doctest::Approx(sum({.start = start, .end = start + 2.0})).epsilon(1e-5));
  }
}

TEST_CASE("before the first command the drive is at rest, or goes on as it was measured") {
  const Point at{0.3, 1.5, 0.4, 0.8, 0.4, 0.0, 0.0, 1.0};
  const auto first = [&](const ActuatorSpan& window) {
    return actuator_steps(held(at), actuator_of(at), window).steps.front();
  };
  CHECK(first({.start = 0.0, .end = 1.0}).forward == 0.0);
  CHECK(first({.start = 0.0, .end = 0.4, .initial = BodyTwist{0.3, 0.0, 0.1}}).forward ==
        doctest::Approx(0.3 * 0.1).epsilon(1e-9));
}

}  // namespace
}  // namespace slipwise
