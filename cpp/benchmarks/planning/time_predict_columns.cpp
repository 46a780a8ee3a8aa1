// SPDX-License-Identifier: Apache-2.0
// Time of the whole motion model on columns of velocities, 2048 rollouts of 56 periods, on one core.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "slipwise/planning/predict_columns.hpp"

namespace {

using namespace slipwise;  // NOLINT(google-build-using-namespace)

constexpr std::size_t kRollouts = 2048, kPeriods = 56;
constexpr double kPeriod = 0.05;  // [s]

struct Case {
  const char* name;
  const char* basis;
  bool dynamics;
};

void time(const Case& chosen, const std::vector<float>& v, const std::vector<float>& omega) {
  const MotionModel motion(named_basis(chosen.basis), {.dynamics = chosen.dynamics});
  Eigen::VectorXd parameters = Eigen::VectorXd::Constant(motion.size(), 0.03);
  if (chosen.dynamics) {
    parameters.tail(4) << std::log(0.4), std::log(0.3), std::log(0.16), std::log(0.12);
  }
  const RolloutProgram program(motion, parameters, RolloutSetting{.period = kPeriod});
  const std::vector<DriveCommand> in_flight(4, DriveCommand{.v = 0.5});
  std::vector<float> vx(kRollouts * kPeriods), vy(kRollouts * kPeriods), wz(kRollouts * kPeriods);
  std::vector<double> times;
  for (int run = 0; run < 301; ++run) {
    const auto start = std::chrono::steady_clock::now();
    planning::predict_columns(program, {v.data(), omega.data(), kRollouts, kPeriods},
                              {.drive = {.v = 0.5}, .in_flight = in_flight}, {vx.data(), vy.data(), wz.data()});
    times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::ranges::sort(times);
  std::printf("%-40s %8.3f %8.3f %8.3f  (vx %.3f)\n", chosen.name, times.front(), times[times.size() / 2],
              times[times.size() * 95 / 100], static_cast<double>(vx.back()));
}

}  // namespace

int main() {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  std::vector<float> v(kRollouts * kPeriods), omega(kRollouts * kPeriods);
  std::ranges::generate(v, [&] { return 0.7F + 0.3F * uniform(random); });
  std::ranges::generate(omega, [&] { return 0.6F * uniform(random); });
  std::printf("velocities of 2048 x 56 on one core, %s\n", std::string(name_of(best_instruction_level())).c_str());
  std::printf("%-40s %8s %8s %8s\n", "model", "best ms", "median", "95 %");
  for (const Case& chosen : {Case{"edd-2", "edd-2", false}, Case{"odd-even-10", "odd-even-10", false},
                             Case{"odd-even-10 with lag and delay", "odd-even-10", true}}) {
    time(chosen, v, omega);
  }
  return 0;
}
