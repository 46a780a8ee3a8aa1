// SPDX-License-Identifier: Apache-2.0
// A stretch of a measured stream, at evenly spaced times.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace slipwise {

using SampleRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// How windows are cut; rates are those of training, to which others are interpolated.
struct TerrainCutting {
  double seconds = 5.0;     ///< of a window
  double imu_rate = 0.0;    ///< [Hz], 0 where there was no IMU
  double drive_rate = 0.0;  ///< [Hz], 0 where there were no currents
};

/// A stream from `start` on for `seconds` at `rate` [Hz], [n, D], from samples at increasing `times` [N] with `values`
/// [N, D]; empty where five samples or more are missing in a row, or the rate is 0.
/// \throws std::invalid_argument when there are not as many values as times.
std::optional<Eigen::MatrixXd> even_samples(const Eigen::Ref<const Eigen::VectorXd>& times,
                                            const Eigen::Ref<const SampleRows>& values, double start,
                                            const std::array<double, 2>& seconds_and_rate);

}  // namespace slipwise
