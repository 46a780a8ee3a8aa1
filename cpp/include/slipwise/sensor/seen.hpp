// SPDX-License-Identifier: Apache-2.0
// What a sensor measures of a segment, as the robot's poses at a few moments make it (derivations/sensors.md).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "slipwise/lie/se2.hpp"
#include "slipwise/linear/rows.hpp"

namespace slipwise {

inline constexpr std::size_t kMostMoments = 10;
inline constexpr int kMostSensorRows = 4;

/// Which of the learned sizes of noise a row has: that of the way along, of the way across, or of the turn.
enum Direction : std::uint8_t { kAlong, kAcross, kTurn };

/// The directions of rows.
using Directions = Eigen::Matrix<Eigen::Index, Eigen::Dynamic, 1, Eigen::ColMajor, kMostRows, 1>;
/// Stamps of the poses that make a measurement [s].
using Moments = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, static_cast<int>(kMostMoments), 1>;

/// What a sensor looks at: the robot at its moments, seen from where its path begins.
struct View {
  std::span<const Pose2> robot;
  Moments stamps;
  Pose2 place = {};    ///< of the sensor in base_link
  Rows measured = {};  ///< what it measured, next to which turns are unwrapped
};

using RowsByPose = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::ColMajor, kMostSensorRows, 3>;

/// The rows of a sensor that a path makes, with their derivatives by charts (x, y, theta).
struct Seen {
  Rows z;
  std::array<RowsByPose, kMostMoments> by_pose;  ///< of the robot at each moment
  RowsByPose by_place;                           ///< of the sensor in base_link
};

}  // namespace slipwise
