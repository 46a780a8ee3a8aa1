// SPDX-License-Identifier: Apache-2.0
// The derivative of a segment by its slip parameters as the thesis prints it (6.7), beside the exact one.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {

/// Exact: derivations/model.md. Thesis: (6.7), in which yaw slip turns the robot but does not move it.
enum class SegmentJacobian : std::uint8_t { Exact, Thesis };

/// J = integral of Gamma(theta) U dt, thesis (6.7) with (6.9) and (6.11), along a path that is already known.
/// Erratum: Phi is missing, so that positions ignore what yaw slip did before; up to 86 % wrong over 5 s. Columns of
/// lags, delays and the clock offset, which the thesis does not have, are the exact ones.
Eigen::Matrix<double, 3, Eigen::Dynamic> thesis_jacobian(const MotionModel& model, const SegmentLinearization& at,
                                                         const Segment& segment);

/// The one that `kind` names.
RowsJacobian segment_jacobian(SegmentJacobian kind, const MotionModel& model, const SegmentLinearization& at,
                              const Segment& segment);

}  // namespace slipwise
