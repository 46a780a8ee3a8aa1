// SPDX-License-Identifier: Apache-2.0
// Rollouts on a GPU are those of the processor: on a card where there is one, and always on one that the processor
// plays (gpu_on_host).
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "rollout/sample_rollouts.hpp"
#include "slipwise/rollout/gpu/gpu.hpp"

namespace slipwise {
namespace {

bool skipped() {
  const std::string reason = why_no_gpu();
  if (!reason.empty()) {
    MESSAGE("skipped: ", reason);
  }
  return !reason.empty();
}

template <typename Scalar>
double apart(const std::vector<Scalar>& a, const std::vector<double>& b) {
  double worst = a.size() == b.size() ? 0.0 : std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, std::abs(static_cast<double>(a[i]) - b[i]));
  }
  return worst;
}

template <typename Scalar>
double apart(const tests::SamplePaths<Scalar>& a, const tests::SamplePaths<double>& b) {
  return std::max({apart(a.x, b.x), apart(a.y, b.y), apart(a.theta, b.theta)});
}

RolloutProgram sample_program(const char* basis, std::size_t chain_at) {
  const tests::SampleChain actuator = tests::sample_chains()[chain_at];
  const MotionModel model(named_basis(basis), actuator.learned);
  return {model, tests::sample_parameters(model, actuator), {tests::kPeriod}};
}

TEST_CASE("rollouts of 5 s on a GPU are the processor's in every basis and with every actuator") {
  if (skipped()) {
    return;
  }
  Gpu gpu;
  const tests::SampleCommands<double> commands(37, 100, tests::kPeriod);
  const tests::SampleCommands<float> in_float(37, 100, tests::kPeriod);
  std::vector<Basis> bases = tests::all_bases();
  bases.push_back(tests::union_of_all());
  for (const Basis& basis : bases) {
    CAPTURE(basis.name());
    const auto wide = commands.for_basis(basis);
    const auto narrow = in_float.for_basis(basis);
    for (const tests::SampleChain& actuator : tests::sample_chains()) {
      CAPTURE(std::string(actuator.name));
      const MotionModel model(basis, actuator.learned);
      const RolloutProgram program(model, tests::sample_parameters(model, actuator), {tests::kPeriod, 0.3, -0.2});
      const auto expected = tests::roll(program, wide.batch(tests::kStart, tests::kPast));
      CHECK(apart(tests::roll(program, wide.batch(tests::kStart, tests::kPast), {.gpu = &gpu}), expected) < 1e-9);
      // In float, a few are more than 1e-5 m off where a lagging speed passes zero (derivations/rollouts.md).
      CHECK(apart(tests::roll(program, narrow.batch(tests::kStart, tests::kPast), {.gpu = &gpu}), expected) < 2.5e-5);
      CHECK(apart(tests::roll(program, narrow.batch(tests::kStart, tests::kPast)), expected) < 2.5e-5);
    }
  }
}

TEST_CASE("rollouts on a grade are the processor's on a GPU too") {
  if (skipped()) {
    return;
  }
  Gpu gpu;
  const tests::SampleCommands<double> commands(37, 100, tests::kPeriod);
  for (const tests::SampleChain& actuator : tests::sample_chains()) {
    CAPTURE(std::string(actuator.name));
    const MotionModel model(named_basis("drive-9"), actuator.learned);
    const RolloutProgram program(model, tests::sample_parameters(model, actuator),
                                 {.period = tests::kPeriod, .rise_x = 0.12, .rise_y = -0.2});
    const auto expected = tests::roll(program, commands.batch(tests::kStart, tests::kPast));
    CHECK(apart(tests::roll(program, commands.batch(tests::kStart, tests::kPast), {.gpu = &gpu}), expected) < 1e-9);
  }
}

TEST_CASE("rollouts of a drive that steers are the processor's on a GPU too") {
  if (skipped()) {
    return;
  }
  Gpu gpu;
  const tests::SampleCommands<double> commands(37, 100, tests::kPeriod);
  for (const tests::SampleChain& actuator : tests::steering_chains()) {
    CAPTURE(std::string(actuator.name));
    const MotionModel model(named_basis("drive-5"), actuator.learned);
    const RolloutProgram program(model, tests::sample_parameters(model, actuator), {tests::kPeriod});
    const auto expected = tests::roll(program, commands.batch(tests::kStart, tests::kPast));
    CHECK(apart(tests::roll(program, commands.batch(tests::kStart, tests::kPast), {.gpu = &gpu}), expected) < 1e-9);
  }
}

TEST_CASE("rollouts over surfaces ahead are the processor's on a GPU too") {
  if (skipped()) {
    return;
  }
  Gpu gpu;
  const tests::SampleCommands<double> commands(37, 100, tests::kPeriod);
  for (const tests::SampleChain& actuator : tests::sample_chains()) {
    CAPTURE(std::string(actuator.name));
    const MotionModel model(named_basis("drive-9"), actuator.learned);
    const Eigen::VectorXd change = Eigen::VectorXd::LinSpaced(model.slip_size(), -0.1, 0.1);
    const SlipAhead ahead{.edges = {0.5, 1.7}, .changes = {change, -2.0 * change}};
    const RolloutProgram program(model, tests::sample_parameters(model, actuator),
                                 {.period = tests::kPeriod, .ahead = ahead});
    const auto expected = tests::roll(program, commands.batch(tests::kStart, tests::kPast));
    CHECK(apart(tests::roll(program, commands.batch(tests::kStart, tests::kPast), {.gpu = &gpu}), expected) < 1e-9);
  }
}

TEST_CASE("a GPU takes commands as they lie, and starts of every rollout's own") {
  if (skipped()) {
    return;
  }
  Gpu gpu;
  constexpr std::size_t kRollouts = 101, kPeriods = 20;
  const RolloutProgram program = sample_program("odd-even-10", 6);
  const tests::SampleCommands<double> commands(kRollouts, kPeriods, tests::kPeriod);
  std::vector<RolloutStart> starts;
  std::vector<DriveCommand> past;
  std::vector<double> rows(2 * kRollouts * kPeriods);
  for (std::size_t n = 0; n < kRollouts; ++n) {
    const double shift = 0.1 * static_cast<double>(n);
    starts.push_back({{shift, -shift, shift}, {0.01 * shift, 0.1}});
    past.insert(past.end(), {{0.2 * shift, 0.1}, {0.3 * shift, 0.2}});
    for (std::size_t k = 0; k < kPeriods; ++k) {
      rows[2 * (n * kPeriods + k)] = commands.v[k * kRollouts + n];
      rows[2 * (n * kPeriods + k) + 1] = commands.omega[k * kRollouts + n];
    }
  }
  RolloutBatch<double> batch = commands.batch(starts, past);
  const auto expected = tests::roll(program, batch);
  CHECK(apart(tests::roll(program, batch, {.gpu = &gpu}), expected) < 1e-9);
  batch.commands = {rows.data(), rows.data() + 1, 2 * kPeriods, 2};
  CHECK(apart(tests::roll(program, batch, {.gpu = &gpu}), expected) < 1e-9);
  RolloutBatch<double> shorter = commands.batch(starts, past);  // every second rollout, the memory kept is larger
  shorter.rollouts = kRollouts / 2;
  shorter.starts = std::span(starts).first(kRollouts / 2);
  shorter.past = std::span(past).first(2 * (kRollouts / 2));
  shorter.commands.rollout_stride = 2;
  CHECK(apart(tests::roll(program, shorter, {.gpu = &gpu}), tests::roll(program, shorter)) < 1e-9);
}

TEST_CASE("last poses and costs on a GPU are the processor's") {
  if (skipped()) {
    return;
  }
  Gpu gpu;
  std::vector<float> cells(60);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cells[i] = static_cast<float>(i % 7);
  }
  const Costmap map{cells, 6, 10, 0.25, 0.0, -2.5, 100.0F};
  const tests::SampleCommands<double> commands(70, 30, tests::kPeriod);
  for (const std::size_t actuator : {std::size_t{0}, std::size_t{3}}) {
    const RolloutProgram program = sample_program("thesis-15", actuator);
    std::vector<std::vector<double>> found;
    for (Gpu* const where : {static_cast<Gpu*>(nullptr), &gpu}) {
      std::vector<double> all(6 * 70);
      rollout_batch(program, commands.batch(tests::kStart, tests::kPast),
                    {.end_x = &all[0],
                     .end_y = &all[70],
                     .end_theta = &all[140],
                     .map = &map,
                     .cost_sum = &all[210],
                     .cost_highest = &all[280],
                     .cost_lowest = &all[350]},
                    {.gpu = where});
      found.push_back(all);
    }
    CHECK(apart(found[1], found[0]) < 1e-9);
  }
}

TEST_CASE("periods so long that a robot turns round within them are the processor's as well") {
  if (skipped()) {
    return;
  }
  Gpu gpu;
  const MotionModel model(named_basis("odd-even-10"), {});
  const RolloutProgram program(model, tests::sample_slip(model.basis(), 31), {1.0});
  const tests::SampleCommands<double> commands(37, 5, 1.0, 9.0);
  const auto expected = tests::roll(program, commands.batch(tests::kStart));
  CHECK(apart(tests::roll(program, commands.batch(tests::kStart), {.gpu = &gpu}), expected) < 1e-9);
  const tests::SampleCommands<float> in_float(37, 5, 1.0, 9.0);
  CHECK(apart(tests::roll(program, in_float.batch(tests::kStart), {.gpu = &gpu}), expected) < 1e-4);
}

TEST_CASE("what lies on the GPU is neither copied there nor back") {
  if (skipped()) {
    return;
  }
  Gpu gpu;
  constexpr std::size_t kRollouts = 33, kPeriods = 12;
  const RolloutProgram program = sample_program("thesis-15", 3);
  tests::SampleCommands<double> commands(kRollouts, kPeriods, tests::kPeriod);
  GpuMemory v, omega, ends;
  const auto move = [](void* to, const void* from, std::size_t count) {
    gpu_copy({to, count * sizeof(double), from, count * sizeof(double), count * sizeof(double), 1});
  };
  auto* v_there = v.room_for<double>(kRollouts * kPeriods);
  auto* omega_there = omega.room_for<double>(kRollouts * kPeriods);
  auto* ends_there = ends.room_for<double>(kRollouts);
  const auto bring = [&] {
    move(v_there, commands.v.data(), kRollouts * kPeriods);
    move(omega_there, commands.omega.data(), kRollouts * kPeriods);
  };
  bring();
  RolloutBatch<double> batch = commands.batch(tests::kStart, tests::kPast);
  std::vector<double> expected(kRollouts), found(kRollouts);
  rollout_batch(program, batch, {.end_x = expected.data()});
  batch.commands.v = v_there;
  CHECK_THROWS_WITH_AS(rollout_batch(program, batch, {.end_x = ends_there}, {.gpu = &gpu}),
                       doctest::Contains("all in the GPU's"), std::invalid_argument);
  batch.commands.omega = omega_there;
  rollout_batch(program, batch, {.end_x = ends_there}, {.gpu = &gpu});
  move(found.data(), ends_there, kRollouts);
  CHECK(apart(found, expected) < 1e-9);
  for (const std::size_t at : {std::size_t{7}, kRollouts * kPeriods - 1}) {  // the last one is still in the delay
    commands.omega[at] = std::numeric_limits<double>::quiet_NaN();
    bring();
    CHECK_THROWS_WITH_AS(rollout_batch(program, batch, {.end_x = ends_there}, {.gpu = &gpu}),
                         doctest::Contains("are the commands finite"), std::invalid_argument);
    commands.omega[at] = 0.0;
  }
}

TEST_CASE("what cannot be rolled out on a GPU is refused and named") {
  if (skipped()) {
    return;
  }
  Gpu gpu;
  const RolloutProgram program = sample_program("edd-2", 3);
  tests::SampleCommands<double> commands(3, 10, tests::kPeriod);
  commands.omega[29] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS(tests::roll(program, commands.batch(tests::kStart), {.gpu = &gpu}),
                       doctest::Contains("rollout 2 over period 9"), std::invalid_argument);
  commands.omega[29] = 0.0;
  commands.omega[4] = 1e9;
  CHECK_THROWS_WITH_AS(tests::roll(program, commands.batch(tests::kStart), {.gpu = &gpu}),
                       doctest::Contains("thousands of times"), std::invalid_argument);
  commands.omega[4] = 0.0;
  const tests::SampleChain actuator = tests::sample_chains()[3];
  const MotionModel model(named_basis("edd-2"), actuator.learned);
  const RolloutProgram slow(model, tests::sample_parameters(model, actuator), {20.0});
  CHECK_THROWS_WITH_AS(tests::roll(slow, commands.batch(tests::kStart), {.gpu = &gpu}),
                       doctest::Contains("shorter periods"), std::invalid_argument);
  RolloutSetting setting{.period = tests::kPeriod};
  setting.limits.speed.saturation = 0.5;
  const RolloutProgram limited(model, tests::sample_parameters(model, actuator), setting);
  CHECK_THROWS_WITH_AS(tests::roll(limited, commands.batch(tests::kStart), {.gpu = &gpu}),
                       doctest::Contains("on the processor only"), std::invalid_argument);
}

TEST_CASE("without a GPU the reason says what to do") {
  if (const std::string reason = why_no_gpu(); !reason.empty()) {
    CHECK_THROWS_WITH_AS(Gpu(), reason.c_str(), std::invalid_argument);
    CHECK(reason.find("on the processor") != std::string::npos);
  }
}

}  // namespace
}  // namespace slipwise
