// SPDX-License-Identifier: Apache-2.0
// Gauss-Newton with bounds and line search.
#include "slipwise/planning/reach_goal.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "slipwise/lie/angle.hpp"

namespace slipwise {
namespace {

using Metric = Eigen::Matrix<double, kManoeuvreParameters, kManoeuvreParameters>;
constexpr double kSmoothing = 2.0;       // control points so far apart move together by e^-1
constexpr double kDamping = 1e-10;       // of the trace; only keeps a singular system solvable
constexpr double kLengthFraction = 0.5;  // the length moves as readily as this part of its range
constexpr double kSufficient = 0.1;      // part of the promised decrease that a step has to bring
constexpr int kHalvings = 6;

/// How readily the parameters move: neighbouring control points together, all in proportion to their range.
Metric metric_of(const ManoeuvreBounds& bounds) {
  const ManoeuvreVector range = bounds.high - bounds.low;
  Metric metric = Metric::Zero();
  for (int i = 0; i < kCurvaturePoints; ++i) {
    for (int j = 0; j < kCurvaturePoints; ++j) {
      metric(i, j) = 0.25 * range[i] * range[j] * std::exp(-std::abs(i - j) / kSmoothing);
    }
  }
  metric(kLength, kLength) = std::pow(kLengthFraction * range[kLength], 2);
  return metric;
}

Eigen::Vector3d residual_of(const Pose2& goal, const Pose2& end) {
  return {goal.x - end.x, goal.y - end.y, wrap_angle(goal.theta - end.theta)};
}

/// The smallest step in the metric that closes the residual and stays within the bounds: what would leave them is
/// held there, and the others make up for it.
ManoeuvreVector bounded_step(const ManoeuvreVector& at, const ManoeuvreBounds& bounds, Metric metric,
                             const ManoeuvreJacobian& jacobian, const Eigen::Vector3d& residual) {
  ManoeuvreVector held = ManoeuvreVector::Zero();
  ManoeuvreVector step = ManoeuvreVector::Zero();
  for (int round = 0; round < kManoeuvreParameters; ++round) {
    const Eigen::Matrix<double, kManoeuvreParameters, 3> spread = metric * jacobian.transpose();
    Eigen::Matrix3d system = jacobian * spread;
    system.diagonal().array() += kDamping * (system.trace() + 1.0);
    step = held + spread * system.ldlt().solve(residual - jacobian * held);
    bool inside = true;
    for (int i = 0; i < kManoeuvreParameters; ++i) {
      const double wanted = at[i] + step[i];
      const bool leaves = wanted < bounds.low[i] || wanted > bounds.high[i];
      if (leaves && metric(i, i) > 0.0) {
        held[i] = std::clamp(wanted, bounds.low[i], bounds.high[i]) - at[i];
        metric.row(i).setZero();
        metric.col(i).setZero();
        inside = false;
      }
    }
    if (inside) {
      break;
    }
  }
  return (at + step).cwiseMax(bounds.low).cwiseMin(bounds.high) - at;
}

/// Goes along `step` until the gap is small enough for its length; false where no part of it helps.
bool descend(const ReachProblem& problem, const Pose2& goal, const ManoeuvreVector& step, const ReachSettings& settings,
             Reach& reach) {
  const Eigen::Vector3d weight(1.0, 1.0, settings.turn_length);
  const double size = residual_of(goal, reach.pose).cwiseProduct(weight).norm();
  double fraction = 1.0;
  for (int halving = 0; halving <= kHalvings; ++halving, fraction *= 0.5) {
    const ManoeuvreVector trial = reach.parameters + fraction * step;
    const Pose2 pose = manoeuvre_pose(problem.model, problem.frame, trial, problem.start);
    if (residual_of(goal, pose).cwiseProduct(weight).norm() < (1.0 - kSufficient * fraction) * size) {
      reach.parameters = trial;
      reach.pose = pose;
      return true;
    }
  }
  return false;
}

}  // namespace

Reach reach_goal(const ReachProblem& problem, const Pose2& goal, const ManoeuvreVector& guess,
                 const ReachSettings& settings) {
  const Metric metric = metric_of(problem.bounds);
  Reach reach{.parameters = guess.cwiseMax(problem.bounds.low).cwiseMin(problem.bounds.high)};
  bool better = true;
  while (true) {
    const ManoeuvreEnd end = linearize_manoeuvre(problem.model, problem.frame, reach.parameters, problem.start);
    ++reach.linearizations;
    reach.pose = end.pose;
    const Eigen::Vector3d residual = residual_of(goal, end.pose);
    better = descend(problem, goal, bounded_step(reach.parameters, problem.bounds, metric, end.by, residual), settings,
                     reach);
    const Eigen::Vector3d left = residual_of(goal, reach.pose);
    reach.gap_xy = left.head<2>().norm();
    reach.gap_yaw = std::abs(left.z());
    reach.reached = reach.gap_xy <= settings.tolerance_xy && reach.gap_yaw <= settings.tolerance_yaw;
    if (reach.reached || !better || reach.linearizations == settings.iterations) {
      return reach;
    }
  }
}

}  // namespace slipwise
