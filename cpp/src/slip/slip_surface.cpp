// SPDX-License-Identifier: Apache-2.0
// Slip rates, their slopes and their covariance at one state.
#include "slipwise/slip/slip_surface.hpp"

namespace slipwise {

Eigen::Vector3d slip_rate(const Basis& basis, const Eigen::Ref<const Eigen::VectorXd>& alpha, const SlipState& state) {
  const SlipQuantities quantities(state);
  Eigen::Vector3d slip = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < basis.size(); ++i) {
    slip[static_cast<Eigen::Index>(basis.channel(i))] +=
        basis.terms()[i].value(quantities) * alpha[static_cast<Eigen::Index>(i)];
  }
  return slip;
}

SlipRateLinearization linearize_slip_rate(const Basis& basis, const Eigen::Ref<const Eigen::VectorXd>& alpha,
                                          const SlipState& state) {
  const SlipFeatures features = basis.linearize_features(state);
  SlipRateLinearization result{Eigen::Vector3d::Zero(), Eigen::Matrix<double, 3, 2>::Zero(),
                               Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, alpha.size())};
  for (std::size_t i = 0; i < basis.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(basis.channel(i));
    const auto column = static_cast<Eigen::Index>(i);
    result.slip[row] += features.value[column] * alpha[column];
    result.by_drive(row, 0) += features.by_v[column] * alpha[column];
    result.by_drive(row, 1) += features.by_omega[column] * alpha[column];
    result.by_parameter(row, column) = features.value[column];
  }
  return result;
}

Eigen::Matrix3d slip_rate_covariance(const Basis& basis, const Eigen::Ref<const Eigen::MatrixXd>& covariance,
                                     const SlipState& state) {
  const auto u = linearize_slip_rate(basis, Eigen::VectorXd::Zero(covariance.rows()), state).by_parameter;
  return u * covariance * u.transpose();
}

}  // namespace slipwise
