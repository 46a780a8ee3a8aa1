// SPDX-License-Identifier: Apache-2.0
// A sensor of positions: all that it measured over a stretch, as a fit of the way tells of its motion
// (derivations/sensors.md).
#pragma once

#include <Eigen/Core>
#include <span>

#include "slipwise/motion/motion_noise.hpp"
#include "slipwise/sensor/seen.hpp"

namespace slipwise {

/// Positions side by side [m].
using Positions = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, static_cast<int>(kMostMoments)>;
/// A number for each of them.
using OfPositions = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, static_cast<int>(kMostMoments), 1>;

/// Rows: x, y and the turn of the sensor from the start to the end, by a fit of the way.
/// Where the way begins and where it heads is free, so that a way and the same way elsewhere make the same rows.
struct PositionSensor {
  Moments at = {};              ///< stamps of the means of neighbouring positions [s]
  OfPositions weights = {};     ///< one over the variance of each mean, in x and in y [1/m^2]
  Positions fitted = {};        ///< where they are on the fitted way, their weighted mean being zero
  Eigen::Vector3d motion = {};  ///< of the fitted way (x, y, turn)
  /// How much the motion changes with the difference of each mean, x and y, from the fitted one.
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 2 * static_cast<int>(kMostMoments)> gain = {};
  bool turn = true;  ///< whether the turn is its own; otherwise a gyro says how the robot turned

  Directions directions() const;
  Moments moments(double start, double end) const;
  Seen see(const View& view) const;
  RowsCovariance noise(const View& view, const MotionNoise& noise) const;
  /// The motion that positions make, in any frame.
  Eigen::Vector3d motion_by(const Positions& positions) const;
  /// Positions were measured so much earlier [s].
  void come_earlier(double seconds);
};

/// The weighted mean.
Eigen::Vector2d centre_of(const Positions& positions, const OfPositions& weights);
/// By which angle `from` is to be turned so that it lies best on `onto`, whose weighted means are zero, and how much of
/// the squared lengths goes together then.
struct BestTurn {
  double angle;     ///< [rad]
  double together;  ///< [m^2]
};
BestTurn best_turn(const Positions& from, const Positions& onto, const OfPositions& weights);

}  // namespace slipwise
