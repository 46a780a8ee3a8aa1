// SPDX-License-Identifier: Apache-2.0
// What knows no slip and no lag, for tests of predictions.
#pragma once

#include <Eigen/Core>

#include "slipwise/filter/motion_posterior.hpp"

inline slipwise::MotionPosterior kinematic_baseline() {
  return {.model = {},
          .estimate = {Eigen::VectorXd(0), Eigen::MatrixXd(0, 0)},
          .prior_std = Eigen::VectorXd(0),
          .noise = {},
          .noise_scale = Eigen::Vector3d::Ones()};
}
