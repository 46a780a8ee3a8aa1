// SPDX-License-Identifier: Apache-2.0
// What the data told about each parameter: posterior against prior, and the direction known least.
#pragma once

#include <Eigen/Core>

#include "slipwise/estimate/estimate.hpp"

namespace slipwise {

struct Observability {
  Eigen::VectorXd ratio;    ///< posterior variance / prior variance per parameter; 1: nothing learned
  Eigen::VectorXd weakest;  ///< unit vector, in prior standard deviations: the combination known least
  double weakest_ratio;     ///< its posterior / prior variance
};

/// \throws std::invalid_argument when sizes differ or a prior standard deviation is not positive.
Observability observability(const Estimate& posterior, const Eigen::Ref<const Eigen::VectorXd>& prior_std);

}  // namespace slipwise
