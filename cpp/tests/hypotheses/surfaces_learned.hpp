// SPDX-License-Identifier: Apache-2.0
// A model average that drives on a surface, and what it remembers of several.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "simulated_drive.hpp"
#include "slipwise/hypotheses/remembering_average.hpp"

namespace slipwise::tests {

inline const DisturbanceModel kWhiteSlip{.candidates = {{0.0, 0.0, 1.0}}, .weights = Eigen::VectorXd::Ones(1)};

inline RememberingAverage remembering_average() {
  ModelAverageSettings settings;
  settings.surfaces.remember = true;
  return RememberingAverage({"auto", {{"none", {}, {}, {}}, named_basis("edd-2")}, {}, {}, settings});
}

/// Learns some segments of 2 s on a surface that takes a part of the turns; `learned` is called after each.
inline void drive_on_surface(
    RememberingAverage& average, double yaw_slip, std::uint64_t seed, std::size_t windows = 40,
    const std::function<void()>& learned = [] {}) {
  const MotionNoise noise{.psd_time = {1e-4, 1e-4, 1e-4}, .pose_std_xy = 0.01, .pose_std_yaw = 0.004};
  const auto drive = simulate_drive({named_basis("edd-2"), {}}, Eigen::Vector2d(-0.05, yaw_slip),
                                    {.seed = seed, .windows = windows, .window = 2.0, .noise = noise});
  for (const Segment& segment : drive.segments) {
    average.start(drive.inputs, segment);
    while (average.advance()) {
    }
    learned();
  }
}

/// What averages that drove on nothing else know of surfaces that take such parts of the turns.
inline std::vector<SurfaceMemory> surface_memories(const std::vector<double>& yaw_slips) {
  std::vector<SurfaceMemory> all;
  for (const double yaw_slip : yaw_slips) {
    RememberingAverage average = remembering_average();
    drive_on_surface(average, yaw_slip, 60 + all.size());
    all.push_back(average.average().remember());
  }
  return all;
}

}  // namespace slipwise::tests
