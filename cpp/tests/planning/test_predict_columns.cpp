// SPDX-License-Identifier: Apache-2.0
// Velocities in columns lead, summed as a controller sums them, along the paths of the rollouts.
#include "slipwise/planning/predict_columns.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "rollout/sample_rollouts.hpp"

namespace slipwise {
namespace {

constexpr double kPeriod = 0.05;

struct Velocities {
  std::vector<float> vx, vy, wz;
  bool operator==(const Velocities&) const = default;
};

Velocities predicted(const RolloutProgram& program, const tests::SampleCommands<float>& commands,
                     std::span<const DriveCommand> in_flight, const DriveCommand& drive = {},
                     const RolloutOptions& options = {}) {
  const std::size_t size = commands.rollouts * commands.periods;
  Velocities made{std::vector<float>(size), std::vector<float>(size), std::vector<float>(size)};
  planning::predict_columns(program, {commands.v.data(), commands.omega.data(), commands.rollouts, commands.periods},
                            {.drive = drive, .in_flight = in_flight}, {made.vx.data(), made.vy.data(), made.wz.data()},
                            options);
  return made;
}

/// The furthest that the sums of the velocities come from the rollouts' poses [m, rad].
double apart(const RolloutProgram& program, const tests::SampleCommands<float>& commands,
             std::span<const DriveCommand> in_flight) {
  const RolloutStart start{.pose = {}, .drive = {.v = 0.4, .omega = 0.2}};
  const tests::SamplePaths<float> paths = tests::roll(program, commands.batch({&start, 1}, in_flight));
  const Velocities made = predicted(program, commands, in_flight, start.drive);
  double furthest = 0.0;
  for (std::size_t n = 0; n < commands.rollouts; ++n) {
    double x = 0.0, y = 0.0, yaw = 0.0;
    for (std::size_t k = 0; k < commands.periods; ++k) {
      const std::size_t at = k * commands.rollouts + n;
      const double vx = static_cast<double>(made.vx[at]), vy = static_cast<double>(made.vy[at]);
      x += (vx * std::cos(yaw) - vy * std::sin(yaw)) * kPeriod;
      y += (vx * std::sin(yaw) + vy * std::cos(yaw)) * kPeriod;
      yaw += static_cast<double>(made.wz[at]) * kPeriod;
      furthest = std::max({furthest, std::abs(x - static_cast<double>(paths.x[at])),
                           std::abs(y - static_cast<double>(paths.y[at])),
                           std::abs(yaw - static_cast<double>(paths.theta[at]))});
    }
  }
  return furthest;
}

const std::vector<DriveCommand> kInFlight{{0.5, 0.0}, {0.6, 0.1}, {0.7, 0.3}};

}  // namespace

TEST_CASE("the sums of the velocities are the rollouts' poses, for any actuator") {
  for (const tests::SampleChain& chain : tests::sample_chains()) {
    CAPTURE(chain.name);
    const MotionModel model(named_basis("odd-even-10"), chain.learned);
    const RolloutProgram program(model, tests::sample_parameters(model, chain), {.period = kPeriod});
    for (const std::size_t rollouts : {std::size_t{1}, std::size_t{128}, std::size_t{131}}) {
      CAPTURE(rollouts);
      CHECK(apart(program, {rollouts, 40, kPeriod}, kInFlight) < 2e-5);
    }
  }
}

TEST_CASE("the sums are the poses for turns of more than a series takes, and behind limits") {
  const tests::SampleChain chain = tests::sample_chains().at(3);
  const MotionModel model(named_basis("edd-2"), chain.learned);
  const Eigen::VectorXd parameters = tests::sample_parameters(model, chain);
  CHECK(apart({model, parameters, {.period = kPeriod}}, {130, 40, kPeriod, 30.0}, kInFlight) < 2e-4);
  CommandLimits limits;
  limits.speed = {.dead_band = 0.1, .saturation = 0.9, .slew_rate_up = 0.8, .slew_rate_down = 1.5};
  CHECK(apart({model, parameters, {.period = kPeriod, .limits = limits}}, {130, 40, kPeriod}, kInFlight) < 2e-5);
}

TEST_CASE("a robot without slip, lag and delay does what it is commanded") {
  const MotionModel model;
  const RolloutProgram program(model, Eigen::VectorXd(0), {.period = kPeriod});
  const tests::SampleCommands<float> commands(5, 30, kPeriod);
  const Velocities made = predicted(program, commands, {});
  for (std::size_t i = 0; i < commands.v.size(); ++i) {
    CHECK(made.wz[i] == doctest::Approx(commands.omega[i]).epsilon(1e-3));
    const double half = 0.5 * kPeriod * static_cast<double>(commands.omega[i]);  // the chord of an arc
    CHECK(static_cast<double>(made.vx[i]) ==
          doctest::Approx(static_cast<double>(commands.v[i]) * std::cos(half) * std::sin(half) / half).epsilon(1e-3));
  }
}

TEST_CASE("commands in flight act before those that are sent now") {
  const MotionModel model(named_basis("edd-2"), {.delays = true});
  Eigen::VectorXd parameters(4);
  parameters << 0.0, 0.0, 2.0 * kPeriod, 2.0 * kPeriod;
  const RolloutProgram program(model, parameters, {.period = kPeriod});
  const tests::SampleCommands<float> commands(3, 10, kPeriod);
  const std::vector<DriveCommand> in_flight{{0.1, 0.0}, {0.2, 0.0}};
  const Velocities made = predicted(program, commands, in_flight);
  for (std::size_t n = 0; n < 3; ++n) {
    CHECK(made.vx[n] == doctest::Approx(0.1));
    CHECK(made.vx[3 + n] == doctest::Approx(0.2));
    CHECK(made.vx[6 + n] == doctest::Approx(commands.v[n]).epsilon(1e-3));
  }
}

TEST_CASE("threads give the same bytes") {
  const tests::SampleChain chain = tests::sample_chains().at(3);
  const MotionModel model(named_basis("edd-2"), chain.learned);
  const RolloutProgram program(model, tests::sample_parameters(model, chain), {.period = kPeriod});
  const tests::SampleCommands<float> commands(700, 20, kPeriod);
  CHECK(predicted(program, commands, kInFlight) == predicted(program, commands, kInFlight, {}, {.threads = 3}));
}

TEST_CASE("what cannot be driven is refused, and said where it is") {
  const MotionModel model;
  const RolloutProgram program(model, Eigen::VectorXd(0), {.period = kPeriod});
  tests::SampleCommands<float> commands(200, 4, kPeriod);
  commands.v[2 * 200 + 150] = std::numeric_limits<float>::quiet_NaN();
  std::string said;
  try {
    predicted(program, commands, {});
  } catch (const std::invalid_argument& problem) {
    said = problem.what();
  }
  CHECK(said == "counted from rollout 128: the command of rollout 22 over period 2 is not finite");
  float number = 0.0F;
  CHECK_THROWS_AS(planning::predict_columns(program, {&number, &number, 1, 1}, {}, {&number, nullptr, &number}),
                  std::invalid_argument);
  CHECK_THROWS_AS(planning::predict_columns(program, {&number, &number, 0, 1}, {}, {&number, &number, &number}),
                  std::invalid_argument);
}

}  // namespace slipwise
