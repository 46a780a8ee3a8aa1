// SPDX-License-Identifier: Apache-2.0
// A drive whose slip ratios and slip angle are known: what the two estimators of them are tested on.
#pragma once

#include "simulated_drive.hpp"
#include "slipwise/thesis/slip_ratio_filter.hpp"

namespace slipwise::tests {

inline constexpr double kTestTrack = 0.8;
inline const SlipRatios kTestSlip{.left = 0.18, .right = -0.07, .angle = 0.1};

/// Windows of one second at 0.4 to 1.8 m/s with these slip ratios, and `noise` in slip and poses.
inline SimulatedDrive slip_ratio_drive(std::size_t windows, std::uint64_t seed, const MotionNoise& noise) {
  const LinearSlip linear = linear_slip(kTestSlip, kTestTrack);
  return simulate_drive(slip_ratio_model(), linear.alpha,
                        {.seed = seed, .windows = windows, .window = 1.0, .noise = noise});
}

/// The drive's wheel speeds as one constant input: straight ahead at `v`.
inline InputHistory straight_inputs(double v) {
  const std::vector<double> t{0.0}, speed{v}, zero{0.0};
  return {t, speed, zero, zero};
}

}  // namespace slipwise::tests
