// SPDX-License-Identifier: Apache-2.0
// Prints the numbers of a model file as C++ reads them; what it refuses ends it with the reason.
#include <cstdio>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <stdexcept>

#include "slipwise/motion/model_file.hpp"

int main(int count, char** arguments) {
  try {
    std::ifstream stream(count > 1 ? arguments[1] : "");
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    const slipwise::ModelFile file = slipwise::ModelFile::parse(text);
    const slipwise::RolloutModel model = file.model();
    std::printf("%s %d %d %.17g\n", file.input.c_str(), file.good ? 1 : 0, static_cast<int>(model.motion.size()),
                model.motion.learned().wheelbase);
    for (const auto* axis : {&model.limits.speed, &model.limits.yaw_rate, &model.limits.side}) {
      std::printf("%.17g %.17g %.17g %.17g ", axis->dead_band, axis->saturation, axis->slew_rate_up,
                  axis->slew_rate_down);
    }
    std::printf("%.17g %.17g %.17g\n", model.limits.wheel_separation, model.limits.gain_v, model.limits.gain_omega);
    for (const double number : model.parameters) {
      std::printf("%.17g ", number);
    }
    std::printf("\n");
    for (const double number : model.covariance.reshaped()) {
      std::printf("%.17g ", number);
    }
    std::printf("\n");
  } catch (const std::invalid_argument& problem) {
    std::fprintf(stderr, "%s\n", problem.what());
    return 1;
  }
  return 0;
}
