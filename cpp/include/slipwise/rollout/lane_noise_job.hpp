// SPDX-License-Identifier: Apache-2.0
// What kernels are handed of slip noise: plain numbers, as in lane_job.hpp.
#pragma once

#include <cstddef>
#include <cstdint>

#include "slipwise/rollout/lane_job.hpp"

// Plain arrays: the functions of std::array would be compiled for the processor of one file and called from others.
// NOLINTBEGIN(modernize-avoid-c-arrays)
namespace slipwise {

inline constexpr std::size_t kMostDisturbedLanes = 4;  ///< terms with a disturbance (disturbance_model.hpp)

/// Slip noise (motion_noise.hpp).
template <typename Scalar>
struct LaneNoise {
  Scalar psd_time[3], psd_motion[3], fraction[3];
  Scalar turn_radius, per_straight_radius;
};

/// A future of each rollout of a block: where its random numbers begin, and its slip disturbance.
template <typename Scalar>
struct LaneFutures {
  LaneNoise<Scalar> noise;  ///< of the forward, sideways and angular slip, widened
  std::size_t disturbed;    ///< terms, each in one channel, of V or of the yaw rate
  std::size_t channel[kMostDisturbedLanes];
  bool of_turn[kMostDisturbedLanes];
  alignas(64) Scalar deviation[kMostDisturbedLanes][kMostLanes];  ///< standard deviations, widened
  alignas(64) Scalar kept[kMostLanes];                            ///< of a deviation over a period
  alignas(64) std::uint32_t seeds[4][kMostLanes];
};

}  // namespace slipwise
// NOLINTEND(modernize-avoid-c-arrays)
