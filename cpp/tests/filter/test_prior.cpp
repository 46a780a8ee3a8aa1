// SPDX-License-Identifier: Apache-2.0
// Priors in physical units, and changing them after data were learned.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <cmath>

#include "slipwise/filter/prior.hpp"
#include "slipwise/slip/slip_surface.hpp"

namespace slipwise {
namespace {

constexpr double kSteep = 0.2 * kStandardGravity;  // [m/s^2] the slope that terms of gravity are measured by

TEST_CASE("every term may explain the same fraction of the motion at the reference speeds") {
  const ReferenceSpeeds speeds{.v = 20.0, .omega = 0.3};
  for (const std::string& name : basis_names()) {
    const Basis basis = named_basis(name);
    const Eigen::VectorXd std = slip_prior_std(basis, speeds, 0.3);
    for (std::size_t i = 0; i < basis.size(); ++i) {
      CAPTURE(basis.parameter_name(i));
      Eigen::VectorXd alpha = Eigen::VectorXd::Zero(std.size());
      const auto place = static_cast<Eigen::Index>(i);
      alpha[place] = std[place];
      const auto channel = static_cast<Eigen::Index>(basis.channel(i));
      const SlipState state{.v = speeds.v, .omega = speeds.omega, .gx = kSteep, .gy = kSteep, .vy = speeds.v};
      const double slip = slip_rate(basis, alpha, state)[channel];
      const double reference = basis.channel(i) == Channel::Ang ? speeds.omega : speeds.v;
      CHECK(std::abs(slip) == doctest::Approx(0.3 * reference).epsilon(1e-6));
    }
  }
}

TEST_CASE("lag and delay start at their medians and slip at zero") {
  const MotionModel model(named_basis("edd-2"), {.dynamics = true, .clock_offset = true});
  const PriorSettings settings;
  const Estimate prior = prior_estimate(model, {.v = 1.0, .omega = 1.0}, settings);
  CHECK(prior.mean.head<2>().isZero());
  CHECK(std::exp(prior.mean[2]) == doctest::Approx(settings.time_constant));
  CHECK(std::exp(prior.mean[5]) == doctest::Approx(settings.delay));
  CHECK(std::sqrt(prior.covariance(6, 6)) == doctest::Approx(settings.clock_offset_std));
}

TEST_CASE("changing the prior after learning equals learning under the new prior") {
  const Eigen::VectorXd old_std = Eigen::Vector3d(1.0, 2.0, 0.5);
  const Eigen::VectorXd new_std = Eigen::Vector3d(0.3, 4.0, 0.5);
  const Eigen::MatrixXd data = (Eigen::Matrix3d() << 5, 1, 0, 1, 3, 1, 0, 1, 2).finished();
  const Eigen::VectorXd evidence = Eigen::Vector3d(1.0, -2.0, 0.7);
  const auto posterior = [&](const Eigen::VectorXd& std) {
    Eigen::MatrixXd information = data;
    information.diagonal() += std.cwiseAbs2().cwiseInverse();
    return Estimate{information.inverse() * evidence, information.inverse()};
  };
  const Estimate changed = change_slip_prior(posterior(old_std), old_std, new_std).value();
  const Estimate direct = posterior(new_std);
  CHECK(changed.mean.isApprox(direct.mean, 1e-12));
  CHECK(changed.covariance.isApprox(direct.covariance, 1e-12));
}

TEST_CASE("a posterior that is no Gaussian keeps its prior") {
  const Eigen::MatrixXd singular = Eigen::MatrixXd::Ones(2, 2);
  const Eigen::VectorXd std = Eigen::Vector2d::Ones();
  CHECK_FALSE(change_slip_prior({Eigen::VectorXd::Zero(2), -singular}, std, 2.0 * std).has_value());
}

}  // namespace
}  // namespace slipwise
