// SPDX-License-Identifier: Apache-2.0
// Rollouts behind limits of the drive are what integrate_segment says of the limited commands.
// So holds limited_commands.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "rollout/sample_rollouts.hpp"
#include "slipwise/actuator/command_limits.hpp"

namespace slipwise {
namespace {

const std::vector<DriveCommand> kReversedPast{{0.5, 0.1}, {0.9, 0.0}, {-0.5, 0.6}, {0.4, 0.3}};

struct SampleLimits {
  const char* name;
  CommandLimits limits;
};

std::vector<SampleLimits> sample_limits() {
  const AxisLimits speed{.dead_band = 0.3, .saturation = 1.1, .slew_rate_up = 0.8, .slew_rate_down = 1.7};
  const AxisLimits turn{.dead_band = 0.1, .saturation = 0.7, .slew_rate_up = 1.3, .slew_rate_down = 0.9};
  const AxisLimits side{.dead_band = 0.2, .saturation = 1.2, .slew_rate_up = 0.6, .slew_rate_down = 1.1};
  return {
      {"dead-band and top", {.speed = {.dead_band = 0.5, .saturation = 1.0}, .yaw_rate = {.saturation = 0.5}}},
      {"acceleration alone", {.speed = {.slew_rate_up = 0.7}}},
      {"speed and yaw rate", {.speed = speed, .yaw_rate = turn}},
      {"sides behind a lag", {.side = {.slew_rate_up = 0.6, .slew_rate_down = 1.1, .slew_rate_lag = 0.2}}},
      {"sides", {.side = side, .wheel_separation = 0.6, .gain_v = 1.1, .gain_omega = 0.9}},
      {"all",
       {.speed = speed, .yaw_rate = turn, .side = side, .wheel_separation = 0.6, .gain_v = 1.1, .gain_omega = 0.9}}};
}

/// The commands sent again at the start of each of `pieces` equal parts, which changes nothing that they say; `later`
/// is added to their stamps [s].
InputHistory repeated(const InputHistory& commands, std::size_t pieces, double later) {
  std::vector<double> t, v, vy, omega;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const bool last = i + 1 == commands.size();
    const double hold = last ? 2.0 * tests::kPeriod : commands.time(i + 1) - commands.time(i);
    const std::size_t parts = last ? 2 * pieces : hold < 2.0 * tests::kPeriod ? pieces : 1;  // long ago it needs none
    for (std::size_t k = 0; k < parts; ++k) {
      t.push_back(later + commands.time(i) + hold * static_cast<double>(k) / static_cast<double>(parts));
      v.push_back(commands.sample(i).v);
      vy.push_back(commands.sample(i).vy);
      omega.push_back(commands.sample(i).omega);
    }
  }
  return {t, v, vy, omega};
}

/// With lags that last: behind one of nearly nothing, rounding decides whether what a dead-band blocks is a speed of
/// zero or of 1e-20 m/s, which has a sign.
std::vector<tests::SampleChain> lagging_chains() {
  std::vector<tests::SampleChain> chains = tests::sample_chains();
  for (tests::SampleChain& actuator : chains) {
    for (std::size_t i = 0; i < 2 && actuator.learned.dynamics; ++i) {
      actuator.parameters[i] = std::max(actuator.parameters[i], std::log(0.1));
    }
  }
  return chains;
}

struct Worst {
  double xy = 0.0, yaw = 0.0;
};

/// Largest difference to the integrator of the limited commands, over some rollouts and periods.
template <typename Scalar>
Worst error(const RolloutProgram& program, const MotionModel& model, Eigen::VectorXd parameters,
            const tests::SampleCommands<Scalar>& commands, InstructionLevel level) {
  const auto paths = tests::roll(program, commands.batch(tests::kStart, kReversedPast), {.threads = 1, .level = level});
  const BodyTwist drive{tests::kStart[0].drive.v, 0.0, tests::kStart[0].drive.omega};
  // The integrator leaves out inputs that are stamped after the end, even pieces of a ramp that began before. So the
  // clock offset goes into the stamps, and so does a delay below zero.
  double offset = 0.0;
  if (model.learned().clock_offset) {
    std::swap(offset, parameters[parameters.size() - 1]);
  } else if (model.learned().delays) {
    offset = std::min(parameters.tail<2>().minCoeff(), 0.0);
    parameters.tail<2>().array() -= offset;
  }
  const double piece = tests::kPeriod / static_cast<double>(program.pieces());
  Worst worst;
  for (std::size_t n = 0; n < commands.rollouts; n += 9) {
    const InputHistory history = limited_inputs(
        repeated(commands.input_history(n, kReversedPast), program.pieces(), offset), program.setting().limits, piece);
    for (std::size_t k = commands.periods; k >= 1; k /= 3) {
      const Segment segment{.start = 0.0,
                            .end = commands.period * static_cast<double>(k),
                            .initial = drive,
                            .gx = 0.3,
                            .gy = -0.2,
                            .known = tests::measured_start(model, parameters)};
      const Pose2 end =
          compose(tests::kStart[0].pose, integrate_segment(model, parameters, history, segment).poses.back());
      const std::size_t i = (k - 1) * commands.rollouts + n;
      worst.xy = std::max(worst.xy,
                          std::hypot(static_cast<double>(paths.x[i]) - end.x, static_cast<double>(paths.y[i]) - end.y));
      worst.yaw = std::max(worst.yaw, std::abs(static_cast<double>(paths.theta[i]) - end.theta));
    }
  }
  return worst;
}

TEST_CASE("limited rollouts of 5 s are those of the plain integrator in every basis and with every actuator") {
  const tests::SampleCommands<double> commands(37, 100, tests::kPeriod);
  const tests::SampleCommands<float> in_float(37, 100, tests::kPeriod);
  for (const SampleLimits& sample : sample_limits()) {
    CAPTURE(std::string(sample.name));
    for (const Basis& basis : tests::all_bases()) {
      CAPTURE(basis.name());
      for (const tests::SampleChain& actuator : lagging_chains()) {
        CAPTURE(std::string(actuator.name));
        const MotionModel model(basis, actuator.learned);
        const Eigen::VectorXd parameters = tests::sample_parameters(model, actuator);
        const RolloutProgram program(model, parameters, {tests::kPeriod, 0.3, -0.2, sample.limits});
        for (const InstructionLevel level : kInstructionLevels) {
          if (has_instruction_level(level)) {
            CAPTURE(name_of(level));
            const Worst exact = error(program, model, parameters, commands.for_basis(basis), level);
            CHECK(exact.xy < 1e-9);
            CHECK(exact.yaw < 1e-9);
            const Worst coarse = error(program, model, parameters, in_float.for_basis(basis), level);
            // thesis-15 jumps where a lagging speed passes zero, as test_rollout_batch.cpp says.
            const double bound = actuator.learned.dynamics && basis.name() == "thesis-15" ? 2.5e-5 : 1e-5;
            CHECK(coarse.xy < bound);
            CHECK(coarse.yaw < bound);
          }
        }
      }
    }
  }
}

TEST_CASE("a limited rollout's bytes depend neither on threads nor on its neighbours nor on how the commands lie") {
  const tests::SampleChain actuator = tests::sample_chains()[3];
  const MotionModel model(named_basis("odd-even-10"), actuator.learned);
  const RolloutProgram program(model, tests::sample_parameters(model, actuator),
                               {.period = tests::kPeriod, .limits = sample_limits().back().limits});
  const tests::SampleCommands<float> commands(101, 20, tests::kPeriod);
  const auto one = tests::roll(program, commands.batch(tests::kStart, kReversedPast));
  for (const unsigned threads : {2U, 3U, 200U}) {
    CHECK(tests::roll(program, commands.batch(tests::kStart, kReversedPast), {.threads = threads}) == one);
  }
  const RolloutBatch<float> last{
      1, 20, {&commands.v[100], &commands.omega[100], 101, 101}, tests::kStart, kReversedPast};
  const auto alone = tests::roll(program, last);
  CHECK(alone.x[19] == one.x[19 * 101 + 100]);
  CHECK(alone.theta[19] == one.theta[19 * 101 + 100]);
}

TEST_CASE("costs behind limits are those at the ends of the periods") {
  const MotionModel model(Basis("none", {}, {}, {}), {});
  const RolloutProgram program(model, Eigen::VectorXd(), {.period = 0.1, .limits = {.speed = {.slew_rate_up = 1.0}}});
  const std::vector<float> v(10, 1.0F), omega(10, 0.0F), cells{1.0F, 2.0F, 4.0F, 8.0F, 16.0F};
  const Costmap map{cells, 1, 5, 0.11, 0.0, -0.05, 0.0F};
  const std::vector<RolloutStart> start{{}};
  float sum = 0.0F;
  RolloutOutputs<float> outputs;
  outputs.map = &map;
  outputs.cost_sum = &sum;
  rollout_batch(program, RolloutBatch<float>{1, 10, {v.data(), omega.data(), 1, 1}, start}, outputs);
  float expected = 0.0F;
  for (int k = 1; k <= 10; ++k) {
    expected += cells[static_cast<std::size_t>(0.5 * 0.01 * k * k / 0.11)];
  }
  CHECK(sum == expected);
}

TEST_CASE("behind limits a command that is not finite is refused all the same") {
  const MotionModel model(named_basis("edd-2"), {});
  const Eigen::VectorXd parameters = tests::sample_slip(model.basis(), 31);
  const RolloutProgram program(model, parameters, {.period = tests::kPeriod, .limits = sample_limits().back().limits});
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    tests::SampleCommands<float> commands(5, 4, tests::kPeriod);
    commands.v[7] = wrong;
    CHECK_THROWS_WITH_AS(tests::roll(program, commands.batch(tests::kStart)),
                         "the command of rollout 2 over period 1 is not finite", std::invalid_argument);
  }
  CHECK_THROWS_AS(
      RolloutProgram(model, parameters, {.period = tests::kPeriod, .limits = {.speed = {.saturation = -1.0}}}),
      std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
