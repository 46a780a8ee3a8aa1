// SPDX-License-Identifier: Apache-2.0
// What each basis of a structure took its parameters to be at some time: by these it is held against what came later.
#pragma once

#include <Eigen/Core>

#include "slipwise/filter/motion_posterior.hpp"

namespace slipwise {

struct CandidateMeans {
  Structure structure = Structure::Joint;
  Eigen::VectorXd mean;      ///< [parameters] of their average
  Eigen::MatrixXd by_basis;  ///< [parameters, bases] over all terms
};

/// How far the bases of the structure that predicts were from a measured pose, and last their average.
struct BasisErrors {
  Eigen::VectorXd position;  ///< [bases + 1] m
  Eigen::VectorXd heading;   ///< [bases + 1] rad
};

}  // namespace slipwise
