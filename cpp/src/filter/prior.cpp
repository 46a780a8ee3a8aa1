// SPDX-License-Identifier: Apache-2.0
// Priors in physical units (derivations/filter.md).
#include "slipwise/filter/prior.hpp"

#include <algorithm>
#include <cmath>

#include "slipwise/linear/cholesky.hpp"
#include "slipwise/slip/slip_surface.hpp"

namespace slipwise {
namespace {

constexpr double kSteepSlope = 0.2 * kStandardGravity;  // gravity components of a slope of 11.5 degrees
constexpr double kLeastFeature = 1e-9;

}  // namespace

Eigen::VectorXd slip_prior_std(const Basis& basis, const ReferenceSpeeds& speeds, double fraction) {
  const Eigen::VectorXd features =
      basis
          .linearize_features(
              {.v = speeds.v, .omega = speeds.omega, .gx = kSteepSlope, .gy = kSteepSlope, .vy = speeds.v})
          .value;
  Eigen::VectorXd std(features.size());
  for (Eigen::Index i = 0; i < std.size(); ++i) {
    const double channel = basis.channel(static_cast<std::size_t>(i)) == Channel::Ang ? speeds.omega : speeds.v;
    std[i] = fraction * channel / std::max(std::abs(features[i]), kLeastFeature);
  }
  return std;
}

Eigen::VectorXd slip_prior_std(const Basis& basis, const ReferenceSpeeds& speeds, const PriorSettings& settings) {
  Eigen::VectorXd std = slip_prior_std(basis, speeds, settings.slip_fraction);
  if (settings.straight_side_slip_std) {
    const Eigen::VectorXd straight =
        basis.linearize_features({.v = speeds.v, .omega = 0.0, .gx = 0.0, .gy = 0.0}).value;
    for (std::size_t i = basis.begin(Channel::Lat); i < basis.end(Channel::Lat); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      const double feature = std::max(std::abs(straight[at]), kLeastFeature);
      std[at] = std::min(std[at], *settings.straight_side_slip_std * speeds.v / feature);
    }
  }
  return std;
}

Estimate prior_estimate(const MotionModel& model, const ReferenceSpeeds& speeds, const PriorSettings& settings) {
  Estimate prior{Eigen::VectorXd::Zero(model.size()), Eigen::MatrixXd::Zero(model.size(), model.size())};
  Eigen::VectorXd std(model.size());
  std.head(model.slip_size()) = slip_prior_std(model.basis(), speeds, settings);
  Eigen::Index at = model.slip_size();
  if (model.learned().dynamics) {
    prior.mean.segment<2>(at).setConstant(std::log(settings.time_constant));
    prior.mean.segment<2>(at + 2).setConstant(std::log(settings.delay));
    std.segment<4>(at).setConstant(settings.log_std);
    at += 4;
  }
  if (model.learned().lags) {
    prior.mean.segment<2>(at).setConstant(std::log(settings.body_lag));
    std.segment<2>(at).setConstant(settings.body_lag_log_std);
    at += 2;
  }
  if (model.learned().delays) {  // with the offset of the clocks, which alone may be negative
    std.segment<2>(at).setConstant(settings.clock_offset_std);
    at += 2;
  }
  if (model.learned().response) {
    prior.mean.segment<2>(at).setOnes();
    std.segment<2>(at).setConstant(settings.gain_std);
    std.segment<2>(at + 2).setConstant(settings.slow_fraction_std);
    prior.mean.segment<2>(at + 4).setConstant(std::log(settings.slow_time_constant));
    std.segment<2>(at + 4).setConstant(settings.log_std);
    at += 6;
  }
  if (model.learned().clock_offset) {
    std[at] = settings.clock_offset_std;
    at += 1;
  }
  if (model.learned().sensor_extrinsics) {
    prior.mean.segment<kExtrinsicsParameters>(at) = settings.sensor.vector();
    std.segment<kExtrinsicsParameters>(at) << settings.extrinsics_std, settings.extrinsics_std, settings.sensor_yaw_std;
  }
  prior.covariance.diagonal() = std.cwiseAbs2();
  return prior;
}

std::optional<Estimate> change_slip_prior(const Estimate& estimate, const Eigen::VectorXd& old_std,
                                          const Eigen::VectorXd& new_std) {
  if (old_std.size() == 0) {
    return estimate;
  }
  // In units of the present standard deviations, so that terms of very different size do not spoil the inverse.
  const Eigen::VectorXd unit = estimate.covariance.diagonal().cwiseSqrt();
  const Eigen::VectorXd per_unit = unit.cwiseInverse();
  const Cholesky correlation(per_unit.asDiagonal() * estimate.covariance * per_unit.asDiagonal());
  Eigen::MatrixXd information = correlation.inverse();
  const Eigen::VectorXd evidence = information * per_unit.cwiseProduct(estimate.mean);
  const Eigen::Index slip = old_std.size();
  information.diagonal().head(slip) +=
      unit.head(slip).cwiseAbs2().cwiseProduct(new_std.cwiseAbs2().cwiseInverse() - old_std.cwiseAbs2().cwiseInverse());
  const Cholesky changed(information);
  if (!information.allFinite() || !correlation.positive_definite() || !changed.positive_definite()) {
    return std::nullopt;
  }
  const Eigen::MatrixXd covariance = changed.inverse();
  return Estimate{unit.cwiseProduct(changed.solve(evidence)), unit.asDiagonal() * covariance * unit.asDiagonal()};
}

}  // namespace slipwise
