// SPDX-License-Identifier: Apache-2.0
// Times rollouts per instruction level, basis and command actuator, beside a roofline of counted operations and
// measured peak.
#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "slipwise/rollout/rollout_batch.hpp"

namespace {

using namespace slipwise;  // NOLINT(google-build-using-namespace)

constexpr std::size_t kRollouts = 2048;
constexpr std::size_t kPeriods = 100;
constexpr double kPeriod = 0.05;  // [s]
constexpr int kRuns = 400;

/// Best time of several calls [s].
template <typename F>
double best_seconds(int runs, F work) {
  double best = 1e9;
  for (int i = 0; i < runs; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best;
}

// What the processor can do at most: independent chains of fused multiply-adds, lanes per second. A macro, since a
// vector must be met first in a function that is compiled for its processor.
#pragma GCC optimize("fp-contract=fast")
#define CHAIN(i) chain##i = chain##i * factor + summand;
#define PEAK(bytes)                                                                                           \
  typedef float Vector __attribute__((vector_size(bytes)));                                                   \
  const Vector factor = Vector{} + 0.999F;                                                                    \
  const Vector summand = Vector{} + 0.1F;                                                                     \
  Vector chain0 = summand, chain1 = factor, chain2 = summand + factor, chain3 = factor - summand;             \
  Vector chain4 = chain0 + 1.0F, chain5 = chain1 + 1.0F, chain6 = chain2 + 1.0F, chain7 = chain3 + 1.0F;      \
  Vector chain8 = chain0 + 2.0F, chain9 = chain1 + 2.0F;                                                      \
  for (long round = 0; round < kRounds; ++round) {                                                            \
    CHAIN(0) CHAIN(1) CHAIN(2) CHAIN(3) CHAIN(4) CHAIN(5) CHAIN(6) CHAIN(7) CHAIN(8) CHAIN(9)                 \
  }                                                                                                           \
  const Vector sum = chain0 + chain1 + chain2 + chain3 + chain4 + chain5 + chain6 + chain7 + chain8 + chain9; \
  sink = sum[0];                                                                                              \
  return 10.0 * kRounds * ((bytes) / sizeof(float));

constexpr long kRounds = 100000;

double portable_peak(volatile float& sink) { PEAK(16) }
#if defined(__x86_64__)
__attribute__((target("arch=x86-64-v3"))) double avx2_peak(volatile float& sink) { PEAK(32) }
__attribute__((target("arch=x86-64-v4"))) double avx512_peak(volatile float& sink) { PEAK(64) }
#else
double avx2_peak(volatile float& sink) { return portable_peak(sink); }
double avx512_peak(volatile float& sink) { return portable_peak(sink); }
#endif

/// Multiply-adds per second. The portable level of x86-64 has no fused ones: each is two operations, in the peak as in
/// what is counted.
double peak(InstructionLevel level) {
  volatile float sink = 0.0F;
  double done = 0.0;
  const double seconds = best_seconds(50, [&] {
    done = level == InstructionLevel::Avx512 ? avx512_peak(sink)
           : level == InstructionLevel::Avx2 ? avx2_peak(sink)
                                             : portable_peak(sink);
  });
  return done / seconds;
}

/// A model to time: its basis and its actuator.
struct Case {
  const char* words;
  const char* basis;
  ActuatorParameters learned;
  std::vector<double> actuator;
  double operations;  ///< per period in float, as docs/derivations/rollouts.md counts them; 0: not counted
  CommandLimits limits = {};
};

std::vector<Case> cases() {
  const double lag = std::log(0.2);
  const double delay = std::log(0.13);
  const double other = std::log(0.07);
  const double slow = std::log(1.5);
  const AxisLimits ramp{.slew_rate_up = 1.0, .slew_rate_down = 1.5};
  return {{"thesis-15, no actuator", "thesis-15", {}, {}, 34.0},
          {"thesis-15, lag and one delay", "thesis-15", {.dynamics = true}, {lag, lag, delay, delay}, 40.0},
          {"thesis-15, lag and two delays", "thesis-15", {.dynamics = true}, {lag, lag, delay, other}, 80.0},
          {"thesis-15, gains and slow modes",
           "thesis-15",
           {.dynamics = true, .response = true},
           {lag, lag, delay, delay, 0.9, 1.1, 0.3, 0.2, slow, slow},
           48.0},
          {"thesis-15, no actuator, top speeds",
           "thesis-15",
           {},
           {},
           0.0,
           {.speed = {.saturation = 1.2}, .yaw_rate = {.saturation = 0.4}}},
          {"thesis-15, no actuator, ramps", "thesis-15", {}, {}, 0.0, {.speed = ramp, .yaw_rate = ramp}},
          {"thesis-15, one delay, ramps",
           "thesis-15",
           {.dynamics = true},
           {lag, lag, delay, delay},
           0.0,
           {.speed = ramp, .yaw_rate = ramp}},
          {"thesis-15, two delays, ramps",
           "thesis-15",
           {.dynamics = true},
           {lag, lag, delay, other},
           0.0,
           {.speed = ramp, .yaw_rate = ramp}},
          {"thesis-15, two delays, all ramps",
           "thesis-15",
           {.dynamics = true},
           {lag, lag, delay, other},
           0.0,
           {.speed = ramp, .yaw_rate = ramp, .side = ramp}},
          {"odd-even-10, no actuator", "odd-even-10", {}, {}, 0.0},
          {"odd-even-10, lag and two delays", "odd-even-10", {.dynamics = true}, {lag, lag, delay, other}, 0.0},
          {"edd-2, no actuator", "edd-2", {}, {}, 0.0}};
}

template <typename Scalar>
struct Job {
  std::vector<Scalar> v, omega, path;
  std::vector<RolloutStart> starts{{{}, {0.8, 0.1}}};

  Job() : path(3 * kRollouts * kPeriods) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (std::size_t i = 0; i < kRollouts * kPeriods; ++i) {
      v.push_back(static_cast<Scalar>(1.0 + 0.7 * uniform(random)));
      omega.push_back(static_cast<Scalar>(0.6 * uniform(random)));
    }
  }

  /// Best steps per second, where a step is a period of one rollout.
  double speed(const RolloutProgram& program, InstructionLevel level, bool whole_path) {
    const std::size_t poses = whole_path ? kRollouts * kPeriods : kRollouts;
    const RolloutBatch<Scalar> batch{
        kRollouts, kPeriods, {v.data(), omega.data(), 1, static_cast<std::ptrdiff_t>(kRollouts)}, starts, {}};
    RolloutOutputs<Scalar> outputs;
    (whole_path ? outputs.x : outputs.end_x) = path.data();
    (whole_path ? outputs.y : outputs.end_y) = path.data() + poses;
    (whole_path ? outputs.theta : outputs.end_theta) = path.data() + 2 * poses;
    const double seconds = best_seconds(kRuns, [&] { rollout_batch(program, batch, outputs, {1, level}); });
    return static_cast<double>(kRollouts * kPeriods) / seconds;
  }
};

RolloutProgram program_of(const Case& kind) {
  const MotionModel model(named_basis(kind.basis), kind.learned);
  Eigen::VectorXd parameters = Eigen::VectorXd::Constant(model.size(), -0.02);
  for (std::size_t i = 0; i < kind.actuator.size(); ++i) {
    parameters[model.slip_size() + static_cast<Eigen::Index>(i)] = kind.actuator[i];
  }
  return {model, parameters, {.period = kPeriod, .limits = kind.limits}};
}

void report(const Case& kind, InstructionLevel level, double at_most) {
  static Job<float> in_float;    // NOLINT: made once, for all cases
  static Job<double> in_double;  // NOLINT
  const RolloutProgram program = program_of(kind);
  const double ends = in_float.speed(program, level, false);
  const std::string fraction =
      kind.operations > 0.0 ? std::to_string(static_cast<int>(std::lround(100.0 * ends * kind.operations / at_most)))
                            : "-";
  std::printf("  %-32s %-9s %12.2f %12.2f %12.2f %10s\n", kind.words, std::string(name_of(level)).c_str(), ends / 1e9,
              in_float.speed(program, level, true) / 1e9, in_double.speed(program, level, false) / 1e9,
              fraction.c_str());
}

}  // namespace

int main() {
  std::printf("%zu rollouts x %zu periods of %g s on one core, best of %d [1e9 steps/s]\n", kRollouts, kPeriods,
              kPeriod, kRuns);
  std::printf("  %-32s %-9s %12s %12s %12s %10s\n", "", "", "float, ends", "float, path", "double, ends", "% of peak");
  for (const InstructionLevel level : kInstructionLevels) {
    if (!has_instruction_level(level)) {
      continue;
    }
    const double at_most = peak(level);
    std::printf("  peak of multiply-adds in float, %s: %.1f e9 lanes/s\n", std::string(name_of(level)).c_str(),
                at_most / 1e9);
    for (const Case& kind : cases()) {
      report(kind, level, at_most);
    }
  }
  return 0;
}
