// SPDX-License-Identifier: Apache-2.0
// Slip rates, their derivatives and their covariance at one state.
#include "slipwise/slip/slip_surface.hpp"

#include <vector>

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

Eigen::Vector3d slip_rate(const Basis& basis, const Eigen::Ref<const Eigen::VectorXd>& alpha,
                          std::span<const double> features) {
  const auto channel_rate = [&](Channel channel) {
    double sum = 0.0;
    for (std::size_t i = basis.begin(channel); i < basis.end(channel); ++i) {
      sum += features[i] * alpha[static_cast<Eigen::Index>(i)];
    }
    return sum;
  };
  return {channel_rate(Channel::Lon), channel_rate(Channel::Lat), channel_rate(Channel::Ang)};
}

Eigen::Matrix<double, 3, 2> slip_rate_by_drive(const Basis& basis, const Eigen::Ref<const Eigen::VectorXd>& alpha,
                                               const SlipState& state) {
  const SlipQuantities quantities(state);
  Eigen::Matrix<double, 3, 2> derivatives = Eigen::Matrix<double, 3, 2>::Zero();
  for (std::size_t i = 0; i < basis.size(); ++i) {
    const TermValue term = basis.terms()[i].linearize(quantities);
    const Eigen::RowVector2d by_drive(term.by_v, term.by_omega);
    derivatives.row(static_cast<Eigen::Index>(basis.channel(i))) += alpha[static_cast<Eigen::Index>(i)] * by_drive;
  }
  return derivatives;
}

Eigen::Vector3d slip_rate_by_sideways(const Basis& basis, const Eigen::Ref<const Eigen::VectorXd>& alpha,
                                      const SlipState& state) {
  const SlipQuantities quantities(state);
  Eigen::Vector3d derivative = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < basis.size(); ++i) {
    derivative[static_cast<Eigen::Index>(basis.channel(i))] +=
        alpha[static_cast<Eigen::Index>(i)] * basis.terms()[i].linearize(quantities).by_vy;
  }
  return derivative;
}

Eigen::Vector3d slip_rate_by_heading(const Basis& basis, const Eigen::Ref<const Eigen::VectorXd>& alpha,
                                     const SlipState& state) {
  const SlipQuantities quantities(state);
  Eigen::Vector3d derivative = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < basis.size(); ++i) {
    const Term& term = basis.terms()[i];
    double value = term.coefficient();
    double by = 0.0;
    for (const Quantity factor : term.factors()) {
      const double x = quantities.value[static_cast<std::size_t>(factor)];
      by *= x;
      by += factor == Quantity::CosYaw ? -value * state.sin_yaw : 0.0;
      by += factor == Quantity::SinYaw ? value * state.cos_yaw : 0.0;
      value *= x;
    }
    derivative[static_cast<Eigen::Index>(basis.channel(i))] += alpha[static_cast<Eigen::Index>(i)] * by;
  }
  return derivative;
}

SlipRateLinearization linearize_slip_rate(const Basis& basis, const Eigen::Ref<const Eigen::VectorXd>& alpha,
                                          const SlipState& state) {
  std::vector<double> features(basis.size());
  basis.features(state, features);
  SlipRateLinearization result{slip_rate(basis, alpha, features), slip_rate_by_drive(basis, alpha, state),
                               Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, alpha.size())};
  for (std::size_t i = 0; i < basis.size(); ++i) {
    result.by_parameter(static_cast<Eigen::Index>(basis.channel(i)), static_cast<Eigen::Index>(i)) = features[i];
  }
  return result;
}

Eigen::Matrix3d slip_rate_covariance(const Basis& basis, const Eigen::Ref<const Eigen::MatrixXd>& covariance,
                                     const SlipState& state) {
  const auto u = linearize_slip_rate(basis, Eigen::VectorXd::Zero(covariance.rows()), state).by_parameter;
  return u * covariance * u.transpose();
}

}  // namespace slipwise
