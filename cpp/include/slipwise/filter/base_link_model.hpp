// SPDX-License-Identifier: Apache-2.0
// What a robot does, without the place and the clock of the sensor that showed it.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "slipwise/filter/estimate.hpp"
#include "slipwise/motion/motion_model.hpp"

namespace slipwise {

/// Where the clock offset stands among the parameters, if it is learned.
std::optional<Eigen::Index> place_of_offset(const MotionModel& model);

/// How late lags of the body alone make it, as one time for both axes: half of each [s]. That is its derivative by
/// their logarithms too.
Eigen::Vector2d lateness_of_lags(const MotionModel& model, const Eigen::VectorXd& parameters);

/// A model and its parameters.
struct KnownModel {
  MotionModel model;
  Estimate estimate;
};

/// The same of base_link, by the clock of the inputs. No pose is stamped before it happens: where poses are surely
/// stamped earlier than wheel speeds (the clock offset is below zero by twice its standard deviation), it is the wheel
/// speeds that are late, and the delays from commands to these are longer than those to the motion, by as much.
KnownModel of_base_link(const MotionModel& model, const Estimate& estimate);

}  // namespace slipwise
