// SPDX-License-Identifier: Apache-2.0
// Asks a learned model which of some commands brings the robot nearest to a goal in 4 s.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <slipwise/actuator/command_limits.hpp>
#include <slipwise/segment/integrate_segment.hpp>
#include <string>
#include <vector>

#include "model.h"  // slipwise export model.yaml --to c-header -o model.h

/// The model as the library has it.
slipwise::MotionModel learned_model() {
  const std::vector<std::string> lon{SLIPWISE_TERMS_LON}, lat{SLIPWISE_TERMS_LAT}, ang{SLIPWISE_TERMS_ANG};
  const slipwise::ActuatorParameters actuator{.dynamics = SLIPWISE_HAS_DYNAMICS,
                                              .response = SLIPWISE_HAS_RESPONSE,
                                              .delays = SLIPWISE_HAS_DELAYS,
                                              .lags = SLIPWISE_HAS_LAGS,
                                              .wheelbase = SLIPWISE_WHEELBASE};
  return {{"learned", lon, lat, ang}, actuator};
}

/// The drive's learned limits; without any, commands pass as they are.
slipwise::CommandLimits learned_limits() {
  return {.speed = {SLIPWISE_LIMITS_SPEED},
          .yaw_rate = {SLIPWISE_LIMITS_YAW_RATE},
          .side = {SLIPWISE_LIMITS_SIDE},
          .wheel_separation = SLIPWISE_LIMITS_WHEEL_SEPARATION,
          .gain_v = SLIPWISE_LIMITS_GAIN_V,
          .gain_omega = SLIPWISE_LIMITS_GAIN_OMEGA};
}

int main() {
  const slipwise::MotionModel model = learned_model();
  const std::vector<double> values{SLIPWISE_PARAMETERS};
  const Eigen::VectorXd parameters = Eigen::Map<const Eigen::VectorXd>(values.data(), model.size());
  const double now = 10.0, ahead = 4.0, goal_x = 2.0, goal_y = 1.5;

  double best_rate = 0.0, least = INFINITY, apart = 0.0;
  for (const double rate : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}) {
    // What the robot was commanded before still acts, because of lag and delay; each command is held until the next.
    const std::array<double, 2> t{0.0, now}, v{0.3, 1.0}, vy{0.0, 0.0}, omega{0.0, rate};
    const slipwise::InputHistory commands = slipwise::limited_inputs({t, v, vy, omega}, learned_limits());
    const auto at = slipwise::linearize_segment(model, parameters, commands, {.start = now, .end = now + ahead});
    const slipwise::Pose2 pose = at.pose();  // at.by_parameter is its derivative by the parameters
    const double miss = std::hypot(pose.x - goal_x, pose.y - goal_y);
    std::printf("%.1f rad/s -> x %.4f m, y %.4f m, yaw %.4f rad, %.2f m from the goal\n", rate, pose.x, pose.y,
                pose.theta, miss);
    if (miss < least) {
      least = miss;
      best_rate = rate;
    }

    // The same in plain C, in float and without the library, as on a microcontroller.
    slipwise_command slots[2];
    slipwise_commands ring;
    slipwise_commands_init(&ring, slots, 2);
    slipwise_command_push(&ring, 0.0f, 0.3f, 0.0f);
    slipwise_command_push(&ring, static_cast<float>(now), 1.0f, static_cast<float>(rate));
    const slipwise_window window{static_cast<float>(now), static_cast<float>(now + ahead), nullptr, 0.0f, 0.0f};
    slipwise_pose small{};
    if (slipwise_predict(&ring, &window, &small, nullptr) != SLIPWISE_OK) {
      return 1;
    }
    apart = std::max(apart, std::hypot(pose.x - small.x, pose.y - small.y));
  }
  std::printf("best: %.1f rad/s; the C header is within %.0e m of the library\n", best_rate, apart);
  return least < 0.5 && apart < 1e-4 ? 0 : 1;
}
