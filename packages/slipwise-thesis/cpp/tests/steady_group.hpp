// SPDX-License-Identifier: Apache-2.0
// Simulated groups of steady segments with white slip noise, an uncertain start and measured poses.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "slipwise/thesis/steady_segment.hpp"

namespace slipwise::tests {

struct SteadyScript {
  BodyTwist command{.v = 0.5, .omega = 0.25};
  Eigen::Vector3d slip{-0.02, 0.01, -0.08};
  SteadyNoise noise{.psd = {4e-4, 2e-4, 3e-4}, .start = {1e-4, 1e-4, 4e-4}};
  int segments = 30;
  int poses = 12;
  double period = 0.25;  ///< between poses [s]
  std::uint64_t seed = 1;
};

/// Integrated in fine steps of noisy twists; the start's error is drawn and observed in all later poses.
inline std::vector<SteadySegment> simulate_group(const SteadyScript& script) {
  constexpr int kSteps = 10;
  std::mt19937_64 random(script.seed);
  std::normal_distribution<double> normal;
  const auto draw = [&](const Eigen::Vector3d& variance) -> Eigen::Vector3d {
    const double x = normal(random), y = normal(random), z = normal(random);
    return variance.cwiseSqrt().cwiseProduct(Eigen::Vector3d(x, y, z));
  };
  const double dt = script.period / kSteps;
  const Eigen::Vector3d twist =
      Eigen::Vector3d(script.command.v, script.command.vy, script.command.omega) + script.slip;
  std::vector<SteadySegment> group;
  for (int j = 0; j < script.segments; ++j) {
    SteadySegment segment{.command = script.command, .times = {0.0}, .poses = {Pose2{}}};
    Pose2 pose = Pose2::from_vector(draw(script.noise.start));
    for (int k = 1; k <= script.poses; ++k) {
      for (int step = 0; step < kSteps; ++step) {
        pose = compose(pose, exp(twist * dt + draw(script.noise.psd * dt)));
      }
      segment.times.push_back(k * script.period);
      segment.poses.push_back(Pose2::from_vector(pose.vector() + draw(script.noise.pose)));
    }
    group.push_back(segment);
  }
  return group;
}

}  // namespace slipwise::tests
