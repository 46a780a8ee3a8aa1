// SPDX-License-Identifier: Apache-2.0
// Time of one iteration of the MPPI controller, 2048 rollouts of 56 periods with all costs, on one core.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "slipwise/planning/mppi.hpp"

namespace {

using namespace slipwise;  // NOLINT(google-build-using-namespace)

struct Case {
  const char* name;
  bool dynamics;
  bool map;
  int models;
};

double median_milliseconds(const Case& chosen) {
  const MotionModel motion(named_basis("odd-even-10"), {.dynamics = chosen.dynamics});
  Eigen::VectorXd parameters = Eigen::VectorXd::Constant(motion.size(), 0.03);
  if (chosen.dynamics) {
    parameters.tail(4) << std::log(0.4), std::log(0.3), std::log(0.16), std::log(0.12);
  }
  const MppiSettings settings;
  std::vector<RolloutProgram> models;
  for (int i = 0; i < chosen.models; ++i) {
    models.emplace_back(motion, parameters, RolloutSetting{.period = settings.period});
  }
  Mppi controller(models, settings);
  const std::vector<float> cells(200 * 200, 1.0F);
  const Costmap map{
      .cells = cells, .rows = 200, .columns = 200, .resolution = 0.1, .origin_x = -10.0, .origin_y = -10.0};
  MppiReference reference;
  for (std::size_t k = 1; k <= settings.periods; ++k) {
    reference.x.push_back(static_cast<float>(0.04 * static_cast<double>(k)));
    reference.y.push_back(0.0F);
    reference.theta.push_back(0.0F);
  }
  std::vector<double> times;
  for (int i = 0; i < 301; ++i) {
    const auto start = std::chrono::steady_clock::now();
    controller.step({.start = {}, .past = std::vector<DriveCommand>(4)}, reference, chosen.map ? &map : nullptr);
    times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::ranges::sort(times);
  std::printf("%-46s %8.2f %8.2f %8.2f\n", chosen.name, times.front(), times[times.size() / 2],
              times[times.size() * 95 / 100]);
  return times[times.size() / 2];
}

}  // namespace

int main() {
  std::printf("MPPI, one iteration of 2048 x 56 on one core, %s\n",
              std::string(name_of(best_instruction_level())).c_str());
  std::printf("%-46s %8s %8s %8s\n", "costs", "best ms", "median", "95 %");
  for (const Case& chosen : {Case{"slip, path", false, false, 1}, Case{"slip and actuator, path", true, false, 1},
                             Case{"slip and actuator, path and costmap", true, true, 1},
                             Case{"slip and actuator, path and costmap, 4 models", true, true, 4}}) {
    median_milliseconds(chosen);
  }
  return 0;
}
