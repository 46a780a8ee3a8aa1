// SPDX-License-Identifier: Apache-2.0
// How far a predicted pose may be off because its inputs are not known well (derivations/sensors.md).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slipwise/actuator/car_curves.hpp"
#include "slipwise/segment/driven_segment.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {

/// Covariance of the chart (x, y, theta) of the sensor's motion over a segment, of its inputs alone.
RowsCovariance input_covariance(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                const DrivenSegment& driven, const InputSpread& spread);
/// The same of its beginnings, which end at `times` [s].
std::vector<Eigen::Matrix3d> input_covariances(const MotionModel& model,
                                               const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                               const DrivenSegment& driven, const InputSpread& spread,
                                               const std::vector<double>& times);

}  // namespace slipwise
