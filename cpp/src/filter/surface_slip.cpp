// SPDX-License-Identifier: Apache-2.0
// Conditioning on the robot, and empirical Bayes over surfaces.
#include "slipwise/filter/surface_slip.hpp"

#include <vector>

#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kGuessed, 2.0);  // surfaces that the guess of their spread counts as
SLIPWISE_TUNING(kSpread, 0.1);   // that guess: of the variance of a first drive's prior, since surfaces share a robot
constexpr int kIterations = 10;  // of expectation and maximisation: the spread settles in a few

Eigen::MatrixXd symmetric(const Eigen::MatrixXd& matrix) { return (matrix + matrix.transpose()) / 2.0; }

/// One surface in units of the first drive's prior.
struct Unit {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

}  // namespace

SurfaceSlip surface_of(const Estimate& estimate, const Eigen::VectorXd& inflation, const Eigen::VectorXd& prior_std,
                       const ReferenceSpeeds& speeds) {
  const Eigen::Index slip = prior_std.size();
  const Eigen::Index robot = estimate.mean.size() - slip;
  const Eigen::MatrixXd& p = estimate.covariance;
  SurfaceSlip surface{.mean = estimate.mean.head(slip),
                      .covariance = p.topLeftCorner(slip, slip),
                      .by_robot = Eigen::MatrixXd::Zero(slip, robot),
                      .robot = estimate.mean.tail(robot),
                      .prior_std = prior_std,
                      .speeds = speeds};
  if (slip > 0 && robot > 0) {
    const Eigen::MatrixXd cross = p.bottomLeftCorner(robot, slip);
    surface.by_robot = solve_symmetric_columns(p.bottomRightCorner(robot, robot), cross).transpose();
    surface.covariance = symmetric(surface.covariance - surface.by_robot * cross);
  }
  const Eigen::VectorXd factors = inflation.head(slip);
  surface.covariance = (factors.asDiagonal() * surface.covariance * factors.asDiagonal()).eval();
  return surface;
}

Estimate joined_with(const SurfaceSlip& surface, const Eigen::Ref<const Eigen::VectorXd>& robot,
                     const Eigen::Ref<const Eigen::MatrixXd>& covariance) {
  const Eigen::Index slip = surface.mean.size();
  const Eigen::Index size = slip + robot.size();
  Estimate joint{Eigen::VectorXd(size), Eigen::MatrixXd::Zero(size, size)};
  const Eigen::MatrixXd cross = surface.by_robot * covariance;
  joint.mean << surface.mean + surface.by_robot * (robot - surface.robot), robot;
  joint.covariance.topLeftCorner(slip, slip) = symmetric(surface.covariance + cross * surface.by_robot.transpose());
  joint.covariance.topRightCorner(slip, robot.size()) = cross;
  joint.covariance.bottomLeftCorner(robot.size(), slip) = cross.transpose();
  joint.covariance.bottomRightCorner(robot.size(), robot.size()) = covariance;
  return joint;
}

SurfaceSlip merged(const SurfaceSlip& a, const SurfaceSlip& b) {
  if (a.mean.size() == 0) {
    return a;
  }
  const Eigen::VectorXd unit = a.covariance.diagonal().cwiseSqrt();
  const Eigen::VectorXd per_unit = unit.cwiseInverse();
  const auto information = [&](const SurfaceSlip& surface) {
    return Cholesky(per_unit.asDiagonal() * surface.covariance * per_unit.asDiagonal()).inverse();
  };
  const Eigen::MatrixXd of_a = information(a);
  const Eigen::MatrixXd of_b = information(b);
  Eigen::MatrixXd both = of_a + of_b;
  both.diagonal() -= unit.cwiseAbs2().cwiseQuotient(b.prior_std.cwiseAbs2());
  const Cholesky factor(both);
  if (!both.allFinite() || !factor.positive_definite()) {
    return a;
  }
  const Eigen::VectorXd mean_b = b.mean + b.by_robot * (a.robot - b.robot);
  SurfaceSlip joined = a;
  joined.mean = unit.cwiseProduct(
      factor.solve(Eigen::VectorXd(of_a * per_unit.cwiseProduct(a.mean) + of_b * per_unit.cwiseProduct(mean_b))));
  joined.covariance = symmetric(unit.asDiagonal() * factor.inverse() * unit.asDiagonal());
  if (a.robot.size() > 0) {
    const Eigen::MatrixXd by_robot =
        of_a * (per_unit.asDiagonal() * a.by_robot) + of_b * (per_unit.asDiagonal() * b.by_robot);
    joined.by_robot = unit.asDiagonal() * factor.solve(by_robot);
  }
  return joined;
}

SurfaceSlip shrunk_prior(std::span<const SurfaceSlip> known, const Eigen::Ref<const Eigen::VectorXd>& robot,
                         const Eigen::VectorXd& first_std, const ReferenceSpeeds& speeds) {
  const Eigen::Index size = first_std.size();
  const Eigen::VectorXd per_std = first_std.cwiseInverse();
  std::vector<Unit> surfaces;
  for (const SurfaceSlip& each : known) {
    surfaces.push_back({per_std.cwiseProduct(each.mean + each.by_robot * (robot - each.robot)),
                        per_std.asDiagonal() * each.covariance * per_std.asDiagonal()});
  }
  Eigen::VectorXd spread = Eigen::VectorXd::Constant(size, kSpread);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(size);
  Eigen::MatrixXd of_mean = Eigen::MatrixXd::Identity(size, size);
  for (int i = 0; i < kIterations && size > 0; ++i) {
    Eigen::MatrixXd information = Eigen::MatrixXd::Identity(size, size);
    Eigen::VectorXd evidence = Eigen::VectorXd::Zero(size);
    std::vector<Eigen::MatrixXd> precisions;
    for (const Unit& each : surfaces) {
      precisions.push_back(Cholesky(each.covariance + Eigen::MatrixXd(spread.asDiagonal())).inverse());
      information += precisions.back();
      evidence += precisions.back() * each.mean;
    }
    const Cholesky factor(information);
    mean = factor.solve(evidence);
    of_mean = factor.inverse();
    Eigen::VectorXd sum = Eigen::VectorXd::Constant(size, kGuessed * kSpread);
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
      const Eigen::VectorXd away = spread.cwiseProduct(precisions[k] * (surfaces[k].mean - mean));
      const Eigen::VectorXd left = spread - spread.cwiseAbs2().cwiseProduct(precisions[k].diagonal());
      sum += away.cwiseAbs2() + left;
    }
    spread = sum / (kGuessed + static_cast<double>(surfaces.size()));
  }
  const Eigen::MatrixXd covariance = of_mean + Eigen::MatrixXd(spread.asDiagonal());
  return {.mean = first_std.cwiseProduct(mean),
          .covariance = first_std.asDiagonal() * covariance * first_std.asDiagonal(),
          .by_robot = Eigen::MatrixXd::Zero(size, robot.size()),
          .robot = robot,
          .prior_std = first_std,
          .speeds = speeds};
}

}  // namespace slipwise
