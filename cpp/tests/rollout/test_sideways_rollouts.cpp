// SPDX-License-Identifier: Apache-2.0
// Rollouts of a robot that drives sideways are what integrate_segment says; laws of mirror, standstill and split steps.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "rollout/sample_rollouts.hpp"
#include "slipwise/actuator/command_limits.hpp"
#include "slipwise/planning/predict_columns.hpp"

namespace slipwise {
namespace {

const std::vector<RolloutStart> kSidewaysStart{{{1.0, -2.0, 0.5}, {0.4, 0.2, -0.3}}};
const std::vector<DriveCommand> kSidewaysPast{{0.5, 0.1, 0.2}, {0.6, 0.0, -0.4}, {0.0, 0.2, 0.3}, {0.4, 0.3, -0.1}};

/// With terms of a sideways speed, alone and mixed with others.
Basis omni_basis() {
  const std::vector<std::string> lon{"V", "abs(Vy)*V"}, lat{"Vy", "V3", "w*V"}, ang{"w", "Vy", "abs(Vy)*w"};
  return {"omni", lon, lat, ang};
}

/// The same slip to the other side: odd and even parts change their signs as they must.
double mirror_sign(const Basis& basis, std::size_t i) {
  int odd = basis.channel(i) == Channel::Lon ? 0 : 1;
  for (const Quantity factor : basis.terms()[i].factors()) {
    odd += factor == Quantity::Omega || factor == Quantity::SideV || factor == Quantity::ThirdHarmonic ? 1 : 0;
  }
  return odd % 2 == 0 ? 1.0 : -1.0;
}

Eigen::VectorXd mirrored(const MotionModel& model, Eigen::VectorXd parameters) {
  for (std::size_t i = 0; i < model.basis().size(); ++i) {
    parameters[static_cast<Eigen::Index>(i)] *= mirror_sign(model.basis(), i);
  }
  return parameters;
}

/// Largest difference to the integrator, in position and heading.
template <typename Scalar>
double error(const MotionModel& model, const Eigen::VectorXd& parameters, const CommandLimits& limits,
             InstructionLevel level) {
  const tests::SampleCommands<Scalar> commands = tests::SampleCommands<Scalar>(37, 60, tests::kPeriod).sideways();
  const RolloutProgram program(model, parameters, {.period = tests::kPeriod, .limits = limits, .sideways = true});
  const auto paths =
      tests::roll(program, commands.batch(kSidewaysStart, kSidewaysPast), {.threads = 1, .level = level});
  const BodyTwist drive{kSidewaysStart[0].drive.v, kSidewaysStart[0].drive.vy, kSidewaysStart[0].drive.omega};
  double worst = 0.0;
  for (std::size_t n = 0; n < commands.rollouts; n += 3) {
    const InputHistory history = limited_inputs(commands.input_history(n, kSidewaysPast), limits, kRampPiece);
    const Segment segment{.start = 0.0,
                          .end = tests::kPeriod * static_cast<double>(commands.periods),
                          .initial = drive,
                          .known = tests::measured_start(model, parameters)};
    const Pose2 end =
        compose(kSidewaysStart[0].pose, integrate_segment(model, parameters, history, segment).poses.back());
    const std::size_t i = (commands.periods - 1) * commands.rollouts + n;
    worst =
        std::max({worst, std::hypot(static_cast<double>(paths.x[i]) - end.x, static_cast<double>(paths.y[i]) - end.y),
                  std::abs(static_cast<double>(paths.theta[i]) - end.theta)});
  }
  return worst;
}

TEST_CASE("sideways rollouts are those of the plain integrator with every actuator, with limits and without") {
  const CommandLimits tight{.speed = {.dead_band = 0.1, .saturation = 1.1}, .yaw_rate = {.saturation = 0.4}};
  for (const Basis& basis : {omni_basis(), named_basis("edd-2"), Basis("none", {}, {}, {})}) {
    for (const tests::SampleChain& actuator : tests::sample_chains()) {
      const MotionModel model(basis, actuator.learned);
      const Eigen::VectorXd parameters = tests::sample_parameters(model, actuator);
      for (const CommandLimits& limits : {CommandLimits{}, tight}) {
        for (const InstructionLevel level : kInstructionLevels) {
          if (has_instruction_level(level)) {
            CAPTURE(basis.name());
            CAPTURE(std::string(actuator.name));
            CAPTURE(name_of(level));
            CHECK(error<double>(model, parameters, limits, level) < 1e-9);
            CHECK(error<float>(model, parameters, limits, level) < 3e-5);
          }
        }
      }
    }
  }
}

TEST_CASE("what mirrors left and right mirrors sideways rollouts") {
  const tests::SampleCommands<double> commands = tests::SampleCommands<double>(16, 40, tests::kPeriod).sideways();
  tests::SampleCommands<double> other = commands;
  const std::vector<RolloutStart> at_rest{{}};
  for (std::size_t i = 0; i < other.v.size(); ++i) {
    other.vy[i] *= -1.0;
    other.omega[i] *= -1.0;
  }
  for (const tests::SampleChain& actuator : tests::sample_chains()) {
    CAPTURE(std::string(actuator.name));
    const MotionModel model(omni_basis(), actuator.learned);
    const Eigen::VectorXd parameters = tests::sample_parameters(model, actuator);
    const RolloutProgram program(model, parameters, {.period = tests::kPeriod});
    const RolloutProgram mirror(model, mirrored(model, parameters), {.period = tests::kPeriod});
    const auto paths = tests::roll(program, commands.batch(at_rest));
    const auto seen = tests::roll(mirror, other.batch(at_rest));
    double worst = 0.0;
    for (std::size_t i = 0; i < paths.x.size(); ++i) {
      worst = std::max({worst, std::abs(paths.x[i] - seen.x[i]), std::abs(paths.y[i] + seen.y[i]),
                        std::abs(paths.theta[i] + seen.theta[i])});
    }
    CHECK(worst < 1e-12);
  }
}

TEST_CASE("zero commands give zero motion, and a period that is split in two gives the same path") {
  const MotionModel model(omni_basis(), {});
  const Eigen::VectorXd parameters = tests::sample_slip(model.basis(), 31);
  const RolloutProgram whole(model, parameters, {.period = tests::kPeriod}),
      half(model, parameters, {.period = 0.5 * tests::kPeriod});
  const std::vector<RolloutStart> at_rest{{}};
  const tests::SampleCommands<double> commands = tests::SampleCommands<double>(16, 20, tests::kPeriod).sideways();
  tests::SampleCommands<double> none = commands, split = commands;
  for (auto* column : {&none.v, &none.omega, &none.vy}) {
    std::ranges::fill(*column, 0.0);
  }
  const auto still = tests::roll(whole, none.batch(at_rest));
  CHECK(std::ranges::all_of(still.x, [](double x) { return x == 0.0; }));
  CHECK(std::ranges::all_of(still.y, [](double y) { return y == 0.0; }));
  split.periods = 2 * commands.periods;
  for (const auto member :
       {&tests::SampleCommands<double>::v, &tests::SampleCommands<double>::omega, &tests::SampleCommands<double>::vy}) {
    (split.*member).clear();
    for (std::size_t k = 0; k < split.periods; ++k) {
      const auto row = (commands.*member).begin() + static_cast<std::ptrdiff_t>(k / 2 * commands.rollouts);
      (split.*member).insert((split.*member).end(), row, row + static_cast<std::ptrdiff_t>(commands.rollouts));
    }
  }
  const auto paths = tests::roll(whole, commands.batch(at_rest)), finer = tests::roll(half, split.batch(at_rest));
  const std::size_t last = (commands.periods - 1) * commands.rollouts, end = (split.periods - 1) * commands.rollouts;
  for (std::size_t n = 0; n < commands.rollouts; ++n) {
    CHECK(std::hypot(paths.x[last + n] - finer.x[end + n], paths.y[last + n] - finer.y[end + n]) < 1e-12);
  }
}

TEST_CASE("columns of velocities follow the sideways speed") {
  const MotionModel model(omni_basis(), {});
  const Eigen::VectorXd parameters = tests::sample_slip(model.basis(), 31);
  const RolloutProgram program(model, parameters, {.period = tests::kPeriod});
  const tests::SampleCommands<float> commands = tests::SampleCommands<float>(40, 3, tests::kPeriod).sideways();
  std::vector<float> vx(commands.v.size()), vy(commands.v.size()), wz(commands.v.size());
  planning::predict_columns(
      program,
      {.v = commands.v.data(), .omega = commands.omega.data(), .rollouts = 40, .periods = 3, .vy = commands.vy.data()},
      {}, {.vx = vx.data(), .vy = vy.data(), .wz = wz.data()});
  const auto paths = tests::roll(program, commands.batch(std::vector<RolloutStart>{{}}));
  for (std::size_t n = 0; n < 40; ++n) {
    CHECK(static_cast<double>(vx[n]) * tests::kPeriod ==
          doctest::Approx(static_cast<double>(paths.x[n])).epsilon(1e-4));
    CHECK(static_cast<double>(vy[n]) * tests::kPeriod ==
          doctest::Approx(static_cast<double>(paths.y[n])).epsilon(1e-4));
  }
}

TEST_CASE("a sideways speed that the model does not take, or misses, is refused and never dropped") {
  const MotionModel plain(named_basis("edd-2"), {}), omni(omni_basis(), {});
  const RolloutProgram two(plain, tests::sample_slip(plain.basis(), 3), {.period = tests::kPeriod});
  const RolloutProgram three(omni, tests::sample_slip(omni.basis(), 3), {.period = tests::kPeriod});
  const tests::SampleCommands<double> ahead(4, 5, tests::kPeriod), aside = ahead.sideways();
  const std::vector<RolloutStart> at_rest{{}}, gliding{{{}, {.vy = 0.1}}};
  CHECK_THROWS_WITH_AS(tests::roll(three, ahead.batch(at_rest)), doctest::Contains("(v, vy, omega)"),
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(tests::roll(two, aside.batch(at_rest)), doctest::Contains("(v, omega)"), std::invalid_argument);
  CHECK_THROWS_AS(tests::roll(two, ahead.batch(gliding)), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
