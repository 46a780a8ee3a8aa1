// SPDX-License-Identifier: Apache-2.0
// What the kernel of tangents is handed beside the job: what the poses are differentiated by, and where their
// covariances go. Plain pointers and numbers, as in lane_job.hpp.
#pragma once

#include <cstddef>
#include <cstdint>

#include "slipwise/rollout/lane_noise_job.hpp"

// Plain arrays: the functions of std::array would be compiled for the processor of one file and called from others.
// NOLINTBEGIN(modernize-avoid-c-arrays)
namespace slipwise {

inline constexpr std::size_t kColumnsTogether = 4;  ///< columns of the covariance's factor that are worked on at once

/// By a column, a product of the slip program changes its share in a channel at this rate: from an edge on, or from
/// the start.
template <typename Scalar>
struct TangentEntry {
  std::uint8_t product, channel;
  std::uint8_t edge;  ///< 0 from the start, 1 from the first edge on
  Scalar rate;
};

/// What a part changes by with one parameter of the actuator.
template <typename Scalar>
struct PartTangent {
  Scalar duration;
  LaneLag<Scalar> v, omega;
};

/// What the three channels of a drive hold at the start changes by with one parameter of the actuator, a number per
/// lane: (v, omega, vy) times (commanded, fast, slow).
template <typename Scalar>
struct StartTangent {
  alignas(64) Scalar by[3][3][kMostLanes];
};

/// A column is something that is not known: a parameter, or slip ahead. Those of the actuator come first, then those
/// that may turn the robot.
template <typename Scalar>
struct LaneTangents {
  std::size_t columns, actuator, turning;
  const std::size_t* first_entry;  ///< [columns + 1]
  const TangentEntry<Scalar>* entries;
  const PartTangent<Scalar>* parts;   ///< [parts][actuator]
  const StartTangent<Scalar>* start;  ///< [actuator]
  const std::uint8_t* moved;  ///< [actuator] whether the answer to speeds, 1, and to yaw rates, 2, changes with it
  /// The columns' covariance is F F^T, F lower triangular: kColumnsTogether of its columns after each other, each from
  /// the row on that is the first of them.
  const Scalar* factor;
  std::size_t disturbed_count;
  const std::size_t* disturbed;  ///< columns with a variance of their own in each period
  const Scalar* disturbance;     ///< [periods][disturbed_count]
  LaneNoise<Scalar> noise;
  Scalar root[3];           ///< of the learned factors of its variances, along the axes of the start
  const Scalar* inflation;  ///< [periods]
  Scalar* state;            ///< room for the block's tangents, twice: tangent_rows rows of lanes each
  Scalar* out;              ///< [6][periods * rollouts]
};

inline constexpr std::size_t kNoiseRows = 13;  ///< symmetric sums of white noise, and of noise that stays

/// Numbers per lane of a block's tangents.
template <typename Scalar>
std::size_t tangent_rows(const LaneTangents<Scalar>& tangents) {
  return 4 * tangents.columns + 9 * tangents.actuator + kNoiseRows;
}

}  // namespace slipwise
// NOLINTEND(modernize-avoid-c-arrays)
