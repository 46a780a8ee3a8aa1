// SPDX-License-Identifier: Apache-2.0
// What a linear measurement with noise of its own does to a covariance, for all filters (derivations/filter.md). Where
// the noise is also that of the state, `identify/channel_run` and `filter/window_model` do it.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "slipwise/linear/rows.hpp"

namespace slipwise {

/// Gain of a measurement z = H x + noise of covariance R, for a state of covariance P; P becomes what it is afterwards,
/// in Joseph's form (I - K H) P (I - K H)^T + K R K^T: symmetric, and of positive variances whatever is rounded.
template <class Matrix, class ByState, class Noise>
auto linear_update(Eigen::PlainObjectBase<Matrix>& covariance, const Eigen::MatrixBase<ByState>& by_state,
                   const Eigen::MatrixBase<Noise>& noise) {
  constexpr int kMeasured = ByState::RowsAtCompileTime;
  constexpr int kStates = Matrix::RowsAtCompileTime;
  constexpr int kMostStates = Matrix::MaxRowsAtCompileTime;
  constexpr int kMost = ByState::MaxRowsAtCompileTime;
  static_assert(kMost > 0 && kMost <= kMostRows);
  using Gain =
      Eigen::Matrix<double, kStates, kMeasured, kStates == 1 ? Eigen::RowMajor : Eigen::ColMajor, kMostStates, kMost>;
  const Eigen::Matrix<double, kMeasured, kStates, kMeasured == 1 ? Eigen::RowMajor : Eigen::ColMajor, kMost,
                      kMostStates>
      spread = by_state * covariance;
  const Eigen::Matrix<double, kMeasured, kMeasured, Eigen::ColMajor, kMost, kMost> innovation =
      spread.lazyProduct(by_state.transpose()) + noise;
  Gain gain = innovation.llt().solve(spread).transpose();
  if (covariance.size() == 0) {
    return gain;  // the kinematic baseline has nothing to learn
  }
  const Matrix keep = Matrix::Identity(covariance.rows(), covariance.cols()) - gain * by_state;
  const Matrix posterior = keep * covariance * keep.transpose() + gain * noise * gain.transpose();
  covariance = (posterior + posterior.transpose()) / 2.0;
  return gain;
}

}  // namespace slipwise
