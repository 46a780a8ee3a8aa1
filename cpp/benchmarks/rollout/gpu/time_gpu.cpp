// SPDX-License-Identifier: Apache-2.0
// Times rollouts on a GPU, with and without copies, beside what its memory and its arithmetic allow; says so where
// there is none.
#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "gpu_peaks.hpp"
#include "slipwise/rollout/gpu/gpu.hpp"
#include "slipwise/rollout/rollout_batch.hpp"

namespace {

using namespace slipwise;  // NOLINT(google-build-using-namespace)

constexpr std::size_t kPeriods = 100;
constexpr double kPeriod = 0.05;  // [s]
constexpr int kRuns = 30;
constexpr double kRead = 2.0 * sizeof(float);         // bytes of a step's commands
constexpr double kWrittenPath = 3.0 * sizeof(float);  // bytes of a step's pose, where all are wanted

/// A model to time; `operations` per period are those of derivations/rollouts.md. 0: not counted.
struct Case {
  const char* words;
  const char* basis;
  bool dynamics;
  double operations;
};

constexpr Case kCases[]{{"thesis-15, no actuator", "thesis-15", false, 34.0},  // NOLINT(modernize-avoid-c-arrays)
                        {"thesis-15, lag and one delay", "thesis-15", true, 40.0},
                        {"odd-even-10, no actuator", "odd-even-10", false, 0.0}};

RolloutProgram program_of(const Case& kind) {
  const MotionModel model(named_basis(kind.basis), {.dynamics = kind.dynamics});
  Eigen::VectorXd parameters = Eigen::VectorXd::Constant(model.size(), -0.02);
  if (kind.dynamics) {
    parameters.tail(4) << std::log(0.2), std::log(0.2), std::log(0.13), std::log(0.13);
  }
  return {model, parameters, {kPeriod}};
}

/// Commands in both memories, and room for results in both.
struct Job {
  std::size_t rollouts;
  std::vector<float> v, omega, results;
  GpuMemory v_there, omega_there, results_there;
  std::vector<RolloutStart> starts{{{}, {0.8, 0.1}}};

  explicit Job(std::size_t n) : rollouts(n), v(n * kPeriods), omega(n * kPeriods), results(3 * n * kPeriods) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
    std::ranges::generate(v, [&] { return 1.0F + 0.7F * uniform(random); });
    std::ranges::generate(omega, [&] { return 0.6F * uniform(random); });
    const std::size_t bytes = v.size() * sizeof(float);
    gpu_copy({v_there.room_for<float>(v.size()), bytes, v.data(), bytes, bytes, 1});
    gpu_copy({omega_there.room_for<float>(v.size()), bytes, omega.data(), bytes, bytes, 1});
  }

  /// Best steps per second, where a step is a period of one rollout.
  double speed(Gpu& gpu, const RolloutProgram& program, bool whole_path, bool copies) {
    const std::size_t poses = whole_path ? rollouts * kPeriods : rollouts;
    RolloutBatch<float> batch{rollouts, kPeriods, {v.data(), omega.data(), 1, 0}, starts, {}};
    batch.commands.period_stride = static_cast<std::ptrdiff_t>(rollouts);
    float* to = results.data();
    if (!copies) {
      batch.commands.v = v_there.room_for<float>(v.size());
      batch.commands.omega = omega_there.room_for<float>(v.size());
      to = results_there.room_for<float>(results.size());
    }
    RolloutOutputs<float> outputs;
    (whole_path ? outputs.x : outputs.end_x) = to;
    (whole_path ? outputs.y : outputs.end_y) = to + poses;
    (whole_path ? outputs.theta : outputs.end_theta) = to + 2 * poses;
    double best = 1e9;
    for (int i = 0; i < kRuns; ++i) {
      const auto start = std::chrono::steady_clock::now();
      rollout_batch(program, batch, outputs, {.gpu = &gpu});
      best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return static_cast<double>(rollouts * kPeriods) / best;
  }
};

std::string percent(double share) { return share > 0.0 ? std::to_string(std::lround(100.0 * share)) : "-"; }

void report(Gpu& gpu, Job& job, double bandwidth, double arithmetic) {
  for (const Case& kind : kCases) {
    const RolloutProgram program = program_of(kind);
    for (const bool whole_path : {false, true}) {
      const double alone = job.speed(gpu, program, whole_path, false);
      const double bytes = kRead + (whole_path ? kWrittenPath : 0.0);
      std::printf("  %-30s %8zu %-5s %12.2f %12.2f %12s %12s\n", kind.words, job.rollouts, whole_path ? "path" : "ends",
                  alone / 1e9, job.speed(gpu, program, whole_path, true) / 1e9,
                  percent(alone * bytes / bandwidth).c_str(), percent(alone * kind.operations / arithmetic).c_str());
    }
  }
}

}  // namespace

int main() {
  if (const std::string reason = why_no_gpu(); !reason.empty()) {
    std::printf("no GPU: %s\n", reason.c_str());
    return 0;
  }
  Gpu gpu;
  const double bandwidth = benchmarks::copy_bandwidth();
  const double arithmetic = benchmarks::multiply_adds();
  std::printf("%s\n", benchmarks::gpu_name().c_str());
  std::printf("  copies %.0f e9 bytes/s, multiply-adds %.2f e12/s, both measured now\n", bandwidth / 1e9,
              arithmetic / 1e12);
  std::printf("  rollouts x %zu periods in float, best of %d [1e9 steps/s]; coefficients are those without copies\n",
              kPeriods, kRuns);
  std::printf("  %-30s %8s %-5s %12s %12s %12s %12s\n", "", "rollouts", "", "no copies", "with copies", "% bandwidth",
              "% arithmetic");
  for (const std::size_t rollouts : {std::size_t{2048}, std::size_t{1} << 18U}) {
    Job job(rollouts);
    report(gpu, job, bandwidth, arithmetic);
  }
  return 0;
}
