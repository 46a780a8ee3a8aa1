// SPDX-License-Identifier: Apache-2.0
// Drives of a robot over surfaces on which it loses a part of its turns, and a learner that remembers them.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "slipwise/online/motion_learner.hpp"
#include "slipwise/online/recording.hpp"

namespace slipwise::tests {

/// Wheel speeds at 20 Hz and poses at 10 Hz of a robot that loses a part of its turns, from `begin` [s] on.
inline Recording drive_on(double yaw_slip, std::uint64_t seed, double seconds, double begin) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> speed(0.3, 1.2);
  std::uniform_real_distribution<double> yaw_rate(-0.8, 0.8);
  std::normal_distribution<double> normal;
  Recording run;
  BodyTwist wheels{};
  Pose2 pose;
  constexpr double kStep = 0.05;
  const auto steps = static_cast<int>(seconds / kStep);
  for (int i = 0; i < steps; ++i) {
    const double t = begin + kStep * i;
    if (i % 40 == 0) {
      wheels = {speed(random), 0.0, yaw_rate(random)};
    }
    run.wheels.push_back({t, wheels});
    if (i % 2 == 0) {
      run.poses.push_back({.t = t,
                           .x = pose.x + 0.005 * normal(random),
                           .y = pose.y + 0.005 * normal(random),
                           .yaw = std::remainder(pose.theta + 0.003 * normal(random), 6.283185307179586)});
    }
    const double turned = (1.0 - yaw_slip + 0.02 * normal(random)) * wheels.omega;
    pose = compose(pose, exp(Eigen::Vector3d(wheels.v * kStep, 0.0, turned * kStep)));
  }
  return run;
}

inline LearnerSettings surface_settings(bool remember) {
  LearnerSettings all;
  all.stream.from_commands = false;
  all.stream.segment_length = 1.0;
  all.stream.horizons = {1.0};
  all.hypotheses.bases = {{"none", {}, {}, {}}, named_basis("edd-2"), named_basis("full-linear-6")};
  all.hypotheses.dynamics = false;
  all.hypotheses.average.surfaces.remember = remember;
  return all;
}

inline constexpr double kVisit = 90.0;  // [s]

/// Drives on one surface after the other; returns the names of those that were taken.
inline std::vector<std::string> visit(MotionLearner& learner, const std::vector<double>& yaw_slips) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < yaw_slips.size(); ++i) {
    learner.start_drive();
    push(learner, drive_on(yaw_slips[i], 50 + i, kVisit, 1000.0 * static_cast<double>(i + 1)));
    learner.end_run();
    const SurfaceBank bank = learner.surfaces();
    names.push_back(bank.present() ? bank.surfaces()[*bank.present()].name : "");
  }
  return names;
}

inline double mean_yaw_error(const MotionLearner& learner, std::size_t first, std::size_t count) {
  const auto held_out = learner.model().held_out.front();
  double sum = 0.0;
  for (std::size_t i = first; i < first + count; ++i) {
    sum += std::abs(held_out[i].measured.z() - held_out[i].pose.z());
  }
  return sum / static_cast<double>(count);
}

}  // namespace slipwise::tests
