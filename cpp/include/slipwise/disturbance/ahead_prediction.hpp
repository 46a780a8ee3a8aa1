// SPDX-License-Identifier: Apache-2.0
// Predicting a segment that leads over several surfaces (derivations/surfaces.md).
#pragma once

#include "slipwise/disturbance/slip_disturbance.hpp"
#include "slipwise/slip/mixed_ahead.hpp"

namespace slipwise {

/// Value and derivative of a segment over several surfaces, by central differences: a parameter of slip moves the slip
/// of all surfaces, and where the robot comes to them.
SegmentLinearization linearize_ahead(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                     const DrivenSegment& driven, const SlipAhead& ahead);

/// Predicts `driven`, as `DisturbanceFilter::predict`, where slip is that of the surfaces ahead: of the posterior, only
/// the estimate of the robot counts.
/// \throws std::invalid_argument when the slip ahead has other terms than the posterior, or as `predict`.
ExpectedPose predict_ahead(const DisturbanceFilter& filter, MotionPosterior posterior, const SlipNow& now,
                           const DrivenSegment& driven, const MixedAhead& mixed);

}  // namespace slipwise
