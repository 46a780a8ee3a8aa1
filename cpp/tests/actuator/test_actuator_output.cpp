// SPDX-License-Identifier: Apache-2.0
// The drive at given moments against closed forms and against the steps that integrate it.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "slipwise/actuator/actuator_output.hpp"

namespace slipwise {
namespace {

InputHistory history(const std::vector<double>& t, const std::vector<double>& v, const std::vector<double>& omega) {
  const std::vector<double> vy(t.size(), 0.0);
  return {t, v, vy, omega};
}

TEST_CASE("a step of the input shows after the delay, and then closes by the lag") {
  const ActuatorModel actuator{.time_constant_v = 0.4, .delay_v = 0.3, .gain_v = 0.8};
  const InputHistory inputs = history({0.0, 1.0}, {0.0, 2.0}, {0.0, 0.0});
  const std::vector<double> times{0.5, 1.2, 1.3, 1.7, 2.5};
  const ActuatorOutput output = actuator_output(inputs, actuator, times, {});
  CHECK(output.v[1] == 0.0);
  CHECK(output.v[2] == 0.0);
  CHECK(output.v[3] == doctest::Approx(1.6 * (1.0 - std::exp(-1.0))));
  CHECK(output.v[4] == doctest::Approx(1.6 * (1.0 - std::exp(-3.0))));
}

TEST_CASE("the drive does what was measured at the first moment, and forgets it by the lag") {
  const ActuatorModel actuator{.time_constant_v = 0.5, .time_constant_omega = 0.25};
  const ActuatorOutput output = actuator_output(history({0.0}, {1.0}, {-1.0}), actuator, std::vector{2.0, 2.5},
                                                {.v = 3.0, .vy = 0.0, .omega = 1.0});
  CHECK(output.v[0] == 3.0);
  CHECK(output.omega[0] == 1.0);
  CHECK(output.v[1] == doctest::Approx(1.0 + 2.0 * std::exp(-1.0)));
  CHECK(output.omega[1] == doctest::Approx(-1.0 + 2.0 * std::exp(-2.0)));
}

TEST_CASE("an input that repeats itself, and moments in between, change nothing") {
  const ActuatorModel actuator{.time_constant_v = 0.3, .time_constant_omega = 0.2, .delay_v = 0.07};
  const ActuatorOutput sparse =
      actuator_output(history({0.0, 1.0}, {1.0, 0.2}, {0.5, -0.5}), actuator, std::vector{0.0, 1.9}, {});
  const ActuatorOutput dense =
      actuator_output(history({0.0, 0.4, 1.0, 1.3}, {1.0, 1.0, 0.2, 0.2}, {0.5, 0.5, -0.5, -0.5}), actuator,
                      std::vector{0.0, 0.3, 0.41, 1.1, 1.9}, {});
  CHECK(dense.v.back() == doctest::Approx(sparse.v.back()).epsilon(1e-14));
  CHECK(dense.omega.back() == doctest::Approx(sparse.omega.back()).epsilon(1e-14));
}

TEST_CASE("the integral of the output is the distance of the drive's steps") {
  const ActuatorModel actuator{.time_constant_v = 0.3, .delay_v = 0.12, .gain_v = 1.1};
  const InputHistory inputs = history({0.0, 0.5, 1.1}, {1.0, -0.4, 0.8}, {0.0, 0.0, 0.0});
  constexpr int kParts = 4000;
  std::vector<double> times{0.2};
  for (int i = 0; i < kParts; ++i) {
    times.push_back(0.2 + (i + 0.5) * 1.8 / kParts);
  }
  const ActuatorOutput output = actuator_output(inputs, actuator, times, {.v = 0.6});
  double sum = 0.0;
  for (std::size_t i = 1; i < times.size(); ++i) {
    sum += output.v[i] * 1.8 / kParts;
  }
  double distance = 0.0;
  for (const ActuatorStep& step :
       actuator_steps(inputs, actuator, {.start = 0.2, .end = 2.0, .initial = BodyTwist{.v = 0.6}}).steps) {
    distance += step.forward;
  }
  CHECK(sum == doctest::Approx(distance).epsilon(1e-6));
}

TEST_CASE("no moments give no output") { CHECK(actuator_output(history({0.0}, {1.0}, {0.0}), {}, {}, {}).v.empty()); }

}  // namespace
}  // namespace slipwise
