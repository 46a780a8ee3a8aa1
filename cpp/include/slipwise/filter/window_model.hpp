// SPDX-License-Identifier: Apache-2.0
// A stretch of a process observed from its start: measurements on the way and its end, with common noise
// (derivations/actuator.md).
#pragma once

#include <Eigen/Core>
#include <functional>

#include "slipwise/filter/estimate.hpp"
#include "slipwise/filter/iekf.hpp"

namespace slipwise {

/// Linearised at a state at the start. The first rows are the measurements, those after them the state at the end.
struct WindowModel {
  Eigen::Index measured;       ///< M
  Eigen::VectorXd value;       ///< [M + N]
  Eigen::MatrixXd derivative;  ///< [M + N, N] by the state at the start
  Eigen::MatrixXd noise;       ///< [M + N, M + N] covariance of what adds to it, the cross-covariances included

  auto observed() const { return value.head(measured); }
  auto observed_jacobian() const { return derivative.topRows(measured); }
  auto observed_noise() const { return noise.topLeftCorner(measured, measured); }
};

/// The model from a state at the start on.
using MeasurementFunction = std::function<WindowModel(const Eigen::VectorXd& state)>;

/// A state at the start, and the model from there.
struct WindowPoint {
  Eigen::VectorXd state;
  WindowModel at;
};

/// S = H P H^T + R of the measurements.
Eigen::MatrixXd innovation_covariance(const Estimate& prior, const WindowModel& at);

/// The most probable state at the start, given the prior and what was measured: from `expected`, the model of the
/// prior's mean. Where not even the first step helps, that mean.
WindowPoint most_probable_start(const Estimate& prior, WindowModel expected, const MeasurementFunction& predict,
                                const Eigen::VectorXd& measured, const IekfSettings& settings);

/// The state at the start given what was measured, its covariance alone.
Eigen::MatrixXd start_covariance(const Estimate& prior, const WindowModel& at);

/// The state at the end given what was measured, from the linearisation at `point`, in Joseph form.
Estimate end_estimate(const Estimate& prior, const WindowPoint& point, const Eigen::VectorXd& measured);

}  // namespace slipwise
