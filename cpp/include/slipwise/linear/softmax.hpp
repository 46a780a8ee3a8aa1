// SPDX-License-Identifier: Apache-2.0
// Probabilities from logarithms that are known but for a constant.
#pragma once

#include <Eigen/Core>

namespace slipwise {

/// Of each row of logarithms [N, K], probabilities that add up to 1.
inline Eigen::MatrixXd softmax_of_rows(const Eigen::Ref<const Eigen::MatrixXd>& logarithms) {
  if (logarithms.cols() == 0) {
    return logarithms;
  }
  const Eigen::ArrayXXd raised = (logarithms.colwise() - logarithms.rowwise().maxCoeff()).array().exp();
  return raised.colwise() / raised.rowwise().sum();
}

}  // namespace slipwise
