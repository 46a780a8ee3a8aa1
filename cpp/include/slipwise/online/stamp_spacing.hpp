// SPDX-License-Identifier: Apache-2.0
// How well an offset of clocks can be known at most: wheel speeds are samples under zero-order hold.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "slipwise/filter/motion_posterior.hpp"

namespace slipwise {

/// How much later poses are stamped than the robot was there, by the clock of the inputs [s].
struct PoseLateness {
  double mean = 0.0;
  double std = 0.0;
};

/// The same with a clock offset no surer than stamps `seconds` apart support after `segments`. Between two samples it
/// is not known when the wheels changed their speed: each change says when only to within the spacing, evenly spread.
/// Residuals hide that where poses and wheels are of one source.
std::shared_ptr<const MotionPosterior> supported(std::shared_ptr<const MotionPosterior> posterior, double seconds,
                                                 std::size_t segments);

/// Whether a lag of the body behind its wheels is surely long enough to be distinguished from a clock that is as late:
/// its logarithm [ln s] and the standard deviation of that.
bool lag_shows(double log_mean, double log_std);

/// By the learned clock offset. Wheel speeds `seconds` apart that drive a model are held, half of that late; where
/// between two of them the wheels changed is not known. Nothing where the offset is not identified, or where the poses
/// come first: nothing is stamped before it happens.
PoseLateness pose_lateness(const MotionPosterior& posterior, double seconds);

/// The same before that is asked whether it is identified, or positive; nothing where no offset is learned. Lags of the
/// body that are too short to show count as lateness.
std::optional<PoseLateness> learned_lateness(const MotionModel& model, const Estimate& estimate, double seconds);

}  // namespace slipwise
