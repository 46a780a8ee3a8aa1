// SPDX-License-Identifier: Apache-2.0
// Rollouts are what integrate_segment says, in every basis, with every actuator, at every instruction level.
// So are its parts: slip_program, actuator_schedule, actuator_start and the lanes of kernels.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "rollout/sample_rollouts.hpp"
#include "slipwise/slip/force_terms.hpp"

namespace slipwise {
namespace {

/// Largest difference of position and heading to the integrator over some rollouts and periods.
template <typename Scalar>
double error(const MotionModel& model, const Eigen::VectorXd& parameters, const tests::SampleCommands<Scalar>& commands,
             InstructionLevel level, const std::vector<RolloutStart>& start = tests::kStart,
             const std::vector<DriveCommand>& past = tests::kPast) {
  const RolloutProgram program(model, parameters, {commands.period, 0.3, -0.2});
  const auto paths = tests::roll(program, commands.batch(start, past), {.threads = 1, .level = level});
  const BodyTwist drive{start[0].drive.v, 0.0, start[0].drive.omega};
  // Where commands act early, the integrator of a shorter segment leaves out those that a rollout already knows.
  const std::size_t fewest = program.actuator().v.shift < 0 ? commands.periods : 1;
  double worst = 0.0;
  for (std::size_t n = 0; n < commands.rollouts; n += 5) {
    const InputHistory history = commands.input_history(n, past);
    for (std::size_t k = commands.periods; k >= fewest; k /= 3) {
      const Segment segment{.start = 0.0,
                            .end = commands.period * static_cast<double>(k),
                            .initial = drive,
                            .gx = 0.3,
                            .gy = -0.2,
                            .known = tests::measured_start(model, parameters)};
      const Pose2 end =
          compose(tests::kStart[0].pose, integrate_segment(model, parameters, history, segment).poses.back());
      const std::size_t i = (k - 1) * commands.rollouts + n;
      worst =
          std::max({worst, std::hypot(static_cast<double>(paths.x[i]) - end.x, static_cast<double>(paths.y[i]) - end.y),
                    std::abs(static_cast<double>(paths.theta[i]) - end.theta)});
    }
  }
  return worst;
}

std::vector<Basis> bases_and_their_union() {
  std::vector<Basis> bases = tests::all_bases();
  bases.push_back(tests::union_of_all());
  return bases;
}

TEST_CASE("rollouts of 5 s are those of the plain integrator in every basis and with every actuator") {
  const tests::SampleCommands<double> commands(37, 100, tests::kPeriod);
  const tests::SampleCommands<float> in_float(37, 100, tests::kPeriod);
  for (const Basis& basis : bases_and_their_union()) {
    CAPTURE(basis.name());
    for (const tests::SampleChain& actuator : tests::sample_chains()) {
      CAPTURE(std::string(actuator.name));
      const MotionModel model(basis, actuator.learned);
      const Eigen::VectorXd parameters = tests::sample_parameters(model, actuator);
      for (const InstructionLevel level : kInstructionLevels) {
        if (has_instruction_level(level)) {
          CAPTURE(name_of(level));
          CHECK(error(model, parameters, commands.for_basis(basis), level) < 1e-9);
          // Where a lagging speed passes zero, the sample of thesis-15 jumps by metres within one period, and by 1e-5 m
          // for a rounding of the speed. Two lags without fused multiply-adds round it more often.
          const bool coarse = level == InstructionLevel::Portable && actuator.learned.response;
          CHECK(error(model, parameters, in_float.for_basis(basis), level) < (coarse ? 2.5e-5 : 1e-5));
        }
      }
    }
  }
}

TEST_CASE(
    "rollouts of a drive that steers are those of the plain integrator, whether it is fast at the start or slow") {
  const std::vector<RolloutStart> slow{{{1.0, -2.0, 0.5}, {0.04, 0.3}}};
  tests::SampleCommands<double> commands(37, 100, tests::kPeriod);
  for (std::size_t i = 5; i < commands.v.size(); i += 37) {  // some stand now and then, with straight or turned wheels
    commands.v[i] = i % 3 == 0 ? 0.0 : i % 3 == 1 ? kStandingSpeed : commands.v[i];
    commands.omega[i] *= i % 3 == 1 ? kStandingSpeed : 1.0;
  }
  tests::SampleCommands<float> in_float(37, 100, tests::kPeriod);
  std::ranges::transform(commands.v, in_float.v.begin(), [](double v) { return static_cast<float>(v); });
  std::ranges::transform(commands.omega, in_float.omega.begin(), [](double v) { return static_cast<float>(v); });
  for (const Basis& basis : {named_basis("edd-2"), named_basis("odd-even-10")}) {
    for (const tests::SampleChain& actuator : tests::steering_chains()) {
      CAPTURE(std::string(actuator.name));
      const MotionModel model(basis, actuator.learned);
      const Eigen::VectorXd parameters = tests::sample_parameters(model, actuator);
      for (const InstructionLevel level : kInstructionLevels) {
        for (const auto& start : {tests::kStart, slow}) {
          if (has_instruction_level(level)) {
            CAPTURE(name_of(level));
            CHECK(error(model, parameters, commands, level, start) < 1e-9);
            if (!actuator.learned.clock_offset) {  // else commands act early, and steps differ where nothing acts
              CHECK(error(model, parameters, commands, level, start, {}) < 5e-5);
            }
            CHECK(error(model, parameters, in_float, level, start) < 5e-5);
          }
        }
      }
    }
  }
}

TEST_CASE("a drive that steers has neither limits of yaw rates nor a sideways speed") {
  const MotionModel model(named_basis("edd-2"), {.wheelbase = 0.4});
  const Eigen::Vector2d slip(0.1, -0.1);
  CHECK_THROWS_AS(RolloutProgram(model, slip, {.period = tests::kPeriod, .limits = {.speed = {.saturation = 1.0}}}),
                  std::invalid_argument);
  CHECK_THROWS_AS(RolloutProgram(model, slip, {.period = tests::kPeriod, .sideways = true}), std::invalid_argument);
  RolloutBatch<double> batch = tests::SampleCommands<double>(1, 1, tests::kPeriod).batch(tests::kStart);
  const double standing = 0.0, unknown = std::nan("");
  batch.commands = {&standing, &unknown, 1, 1};
  CHECK_THROWS_AS(tests::roll(RolloutProgram(model, slip, {tests::kPeriod}), batch), std::invalid_argument);
}

TEST_CASE("periods so long that a robot turns round within them are exact as well") {
  const MotionModel model(named_basis("odd-even-10"), {});
  const Eigen::VectorXd parameters = tests::sample_slip(model.basis(), 31);
  for (const InstructionLevel level : kInstructionLevels) {
    if (has_instruction_level(level)) {
      CHECK(error(model, parameters, tests::SampleCommands<double>(37, 5, 1.0, 9.0), level) < 1e-9);
      CHECK(error(model, parameters, tests::SampleCommands<float>(37, 5, 1.0, 9.0), level) < 1e-4);
    }
  }
}

TEST_CASE("a rollout's bytes depend neither on threads nor on how the commands lie") {
  const tests::SampleChain actuator = tests::sample_chains()[3];
  const MotionModel model(named_basis("odd-even-10"), actuator.learned);
  const RolloutProgram program(model, tests::sample_parameters(model, actuator), {tests::kPeriod});
  const tests::SampleCommands<float> commands(101, 20, tests::kPeriod);
  const auto one = tests::roll(program, commands.batch(tests::kStart, tests::kPast));
  for (const unsigned threads : {2U, 3U, 200U}) {
    CHECK(tests::roll(program, commands.batch(tests::kStart, tests::kPast), {.threads = threads}) == one);
  }
  std::vector<float> rows(2 * 101 * 20);
  for (std::size_t n = 0; n < 101; ++n) {
    for (std::size_t k = 0; k < 20; ++k) {
      rows[2 * (n * 20 + k)] = commands.v[k * 101 + n];
      rows[2 * (n * 20 + k) + 1] = commands.omega[k * 101 + n];
    }
  }
  RolloutBatch<float> batch = commands.batch(tests::kStart, tests::kPast);
  batch.commands = {rows.data(), rows.data() + 1, 40, 2};
  CHECK(tests::roll(program, batch) == one);
}

TEST_CASE("every rollout may have a start of its own") {
  const tests::SampleChain actuator = tests::sample_chains()[3];
  const MotionModel model(named_basis("edd-2"), actuator.learned);
  const RolloutProgram program(model, tests::sample_parameters(model, actuator), {tests::kPeriod});
  const tests::SampleCommands<double> commands(40, 10, tests::kPeriod);
  std::vector<RolloutStart> starts;
  std::vector<DriveCommand> past;
  for (std::size_t n = 0; n < 40; ++n) {
    const double shift = static_cast<double>(n);
    starts.push_back({{shift, -shift, 0.1 * shift}, {0.01 * shift, 0.0}});
    past.insert(past.end(), {{0.02 * shift, 0.1}, {0.03 * shift, 0.2}});
  }
  const auto all = tests::roll(program, commands.batch(starts, past));
  for (const std::size_t n : {std::size_t{0}, std::size_t{17}, std::size_t{39}}) {
    const RolloutBatch<double> single{1,
                                      10,
                                      {&commands.v[n], &commands.omega[n], 40, 40},
                                      std::span(starts).subspan(n, 1),
                                      std::span(past).subspan(2 * n, 2)};
    const auto alone = tests::roll(program, single);
    CHECK(alone.x[9] == all.x[9 * 40 + n]);
    CHECK(alone.y[9] == all.y[9 * 40 + n]);
    CHECK(alone.theta[9] == all.theta[9 * 40 + n]);
  }
}

TEST_CASE("without commands before the start a drive with a slow mode is taken to be settled") {
  const tests::SampleChain actuator = tests::sample_chains()[6];
  const MotionModel model(Basis("none", {}, {}, {}), actuator.learned);
  const Eigen::VectorXd parameters = tests::sample_parameters(model, actuator);
  const RolloutProgram program(model, parameters, {tests::kPeriod});
  const double gain = model.actuator(parameters).gain_v;
  const std::vector<double> v(40, 0.5), omega(40, 0.0);
  const std::vector<RolloutStart> settled{{{}, {0.5 * gain, 0.0}}};
  const RolloutBatch<double> batch{1, 40, {v.data(), omega.data(), 1, 1}, settled};
  CHECK(tests::roll(program, batch).x[39] == doctest::Approx(0.5 * gain * 40 * tests::kPeriod));
}

TEST_CASE("last poses and costs are those along the path") {
  const tests::SampleChain actuator = tests::sample_chains()[3];
  const MotionModel model(named_basis("thesis-15"), actuator.learned);
  const RolloutProgram program(model, tests::sample_parameters(model, actuator), {tests::kPeriod});
  const tests::SampleCommands<double> commands(21, 30, tests::kPeriod);
  const auto path = tests::roll(program, commands.batch(tests::kStart, tests::kPast));
  std::vector<float> cells;
  for (int i = 0; i < 60; ++i) {
    cells.push_back(static_cast<float>(i % 7));
  }
  const Costmap map{cells, 6, 10, 0.25, 0.0, -2.5, 100.0F};
  std::vector<double> end_x(21), end_y(21), end_theta(21), sum(21), highest(21), lowest(21);
  RolloutOutputs<double> outputs{.end_x = end_x.data(),
                                 .end_y = end_y.data(),
                                 .end_theta = end_theta.data(),
                                 .map = &map,
                                 .cost_sum = sum.data(),
                                 .cost_highest = highest.data(),
                                 .cost_lowest = lowest.data()};
  rollout_batch(program, commands.batch(tests::kStart, tests::kPast), outputs);
  RolloutOutputs<double> end_alone{.end_x = end_y.data()};
  for (std::size_t n = 0; n < 21; ++n) {
    double expected_sum = 0.0, expected_highest = -1.0, expected_lowest = 1e9;
    for (std::size_t k = 0; k < 30; ++k) {
      const double column = std::floor(path.x[k * 21 + n] / 0.25);
      const double row = std::floor((path.y[k * 21 + n] + 2.5) / 0.25);
      const bool inside = column >= 0.0 && column < 10.0 && row >= 0.0 && row < 6.0;
      const double cost = inside ? static_cast<double>(cells[static_cast<std::size_t>(row * 10.0 + column)]) : 100.0;
      expected_sum += cost;
      expected_highest = std::max(expected_highest, cost);
      expected_lowest = std::min(expected_lowest, cost);
    }
    CHECK(end_x[n] == path.x[29 * 21 + n]);
    CHECK(end_y[n] == path.y[29 * 21 + n]);
    CHECK(end_theta[n] == path.theta[29 * 21 + n]);
    CHECK(sum[n] == expected_sum);
    CHECK(highest[n] == expected_highest);
    CHECK(lowest[n] == expected_lowest);
  }
  rollout_batch(program, commands.batch(tests::kStart, tests::kPast),
                end_alone);  // takes fewer steps: none for poses on the way
  CHECK(end_y == end_x);
}

TEST_CASE("far from the origin nothing but the last digit is lost") {
  const MotionModel model(named_basis("edd-2"), {});
  const RolloutProgram program(model, tests::sample_slip(model.basis(), 31), {tests::kPeriod});
  const tests::SampleCommands<float> commands(5, 100, tests::kPeriod);
  const std::vector<RolloutStart> near{{{0.0, 0.0, 0.3}, {}}};
  const std::vector<RolloutStart> far{{{4096.0, 0.0, 0.3}, {}}};
  const auto at_origin = tests::roll(program, commands.batch(near));
  const auto far_off = tests::roll(program, commands.batch(far));
  for (std::size_t n = 0; n < 5; ++n) {
    CHECK(std::abs(far_off.x[99 * 5 + n] - 4096.0F - at_origin.x[99 * 5 + n]) <= 5e-4F);
  }
}

std::string refusal(const RolloutProgram& program, const RolloutBatch<double>& batch) {
  try {
    tests::roll(program, batch);
  } catch (const std::invalid_argument& problem) {
    return problem.what();
  }
  return "";
}

TEST_CASE("what cannot be rolled out is refused and named") {
  const tests::SampleChain actuator = tests::sample_chains()[3];
  const MotionModel model(named_basis("edd-2"), actuator.learned);
  const Eigen::VectorXd parameters = tests::sample_parameters(model, actuator);
  const RolloutProgram program(model, parameters, {tests::kPeriod});
  tests::SampleCommands<double> commands(3, 10, tests::kPeriod);
  const auto batch = commands.batch(tests::kStart);
  CHECK(refusal(program, batch).empty());
  auto empty = batch;
  empty.rollouts = 0;
  CHECK(refusal(program, empty).find("empty") != std::string::npos);
  const std::vector<RolloutStart> two(2);
  CHECK(refusal(program, commands.batch(two)).find("2 starts for 3 rollouts") != std::string::npos);
  const std::vector<RolloutStart> nowhere{{{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}, {}}};
  CHECK(refusal(program, commands.batch(nowhere)).find("start 0 is not finite") != std::string::npos);
  for (const std::size_t at : {std::size_t{7}, std::size_t{29}}) {  // the last one is still in the delay at the end
    commands.omega[at] = std::numeric_limits<double>::quiet_NaN();
    CHECK(
        refusal(program, batch).find("rollout " + std::to_string(at % 3) + " over period " + std::to_string(at / 3)) !=
        std::string::npos);
    commands.omega[at] = 0.0;
  }
  commands.omega[4] = 1e9;
  CHECK(refusal(program, batch).find("thousands of times") != std::string::npos);
  for (const double period : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    CHECK_THROWS_AS(RolloutProgram(model, parameters, {period}), std::invalid_argument);
  }
  CHECK_THROWS_AS(RolloutProgram(model, parameters, {tests::kPeriod, std::numeric_limits<double>::quiet_NaN(), 0.0}),
                  std::invalid_argument);
  CHECK_THROWS_AS(RolloutProgram(model, parameters.head(2), {tests::kPeriod}), std::invalid_argument);
  std::vector<std::string> many, none;
  for (int i = 0; i < 64; ++i) {
    many.push_back("V^" + std::to_string(1 + i / 8) + "*w^" + std::to_string(1 + i % 8));
  }
  const Basis windy = with_force(named_basis("edd-2"), ForceFrame::World);  // rollouts know no heading on the map
  for (const Basis& basis : {Basis("more products than a kernel has room for", many, none, none), windy}) {
    const Eigen::VectorXd slip = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(basis.size()), 0.01);
    CHECK_THROWS_AS(RolloutProgram(MotionModel(basis, {}), slip, {tests::kPeriod}), std::invalid_argument);
  }
}

}  // namespace
}  // namespace slipwise
