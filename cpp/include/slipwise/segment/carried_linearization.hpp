// SPDX-License-Identifier: Apache-2.0
// A linearised segment a small step of the parameters away, without linearising it again.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "slipwise/motion/motion_model.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {

/// Carries `at` over a step of the parameters along which the segment is as good as straight: its prediction moves by
/// the derivative, which stays, and so does the path, whose noise hardly changes. Nothing where it bends by more than a
/// tenth of the standard deviations of the `noise` of what measures it.
std::optional<SegmentLinearization> carried(const SegmentLinearization& at, const MotionModel& model,
                                            const Eigen::Ref<const Eigen::VectorXd>& step, const RowsCovariance& noise);

}  // namespace slipwise
