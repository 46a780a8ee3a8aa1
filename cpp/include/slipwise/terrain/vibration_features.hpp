// SPDX-License-Identifier: Apache-2.0
// Describes an IMU's vibration by the logarithm of its power in bands of frequency, axis by axis (Welch's method).
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace slipwise {

/// Edges of the bands [Hz]. Below 0.5 Hz lies how the robot is driven and how steep it is there, not what it drives on.
inline constexpr std::array kBandEdges{0.5, 2.0, 4.0, 6.0, 8.0, 11.0, 14.0, 18.0, 23.0, 29.0, 36.0, 43.0, 50.0};
inline constexpr Eigen::Index kImuAxes = 6;  ///< wx wy wz [rad/s], ax ay az [m/s^2]

/// Bands of frequency at one sampling rate, with the tables of the transform.
class VibrationBands {
 public:
  /// \throws std::invalid_argument when the rate is negative or above 10 kHz.
  explicit VibrationBands(double rate);

  /// Lower and upper edge of each band that the rate can hold [Hz].
  const std::vector<std::array<double, 2>>& edges() const { return edges_; }
  /// Log power of each axis in each band, axis by axis, of samples [n, 6] that are evenly spaced for at least a second.
  /// \throws std::invalid_argument when they are fewer, or not of six axes.
  Eigen::VectorXd features(const Eigen::Ref<const Eigen::MatrixXd>& samples) const;

 private:
  std::vector<std::array<double, 2>> edges_;
  Eigen::Index length_ = 0;                 ///< samples of one periodogram
  Eigen::MatrixXd cosine_;                  ///< [bins, length] of the bins in the bands, with the window
  Eigen::MatrixXd sine_;                    ///< the same
  std::vector<Eigen::Index> first_, last_;  ///< of each band's rows in these
  double window_power_ = 0.0;
};

}  // namespace slipwise
