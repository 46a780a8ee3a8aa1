// SPDX-License-Identifier: Apache-2.0
// The most probable state, given its prior and one nonlinear measurement: Gauss-Newton in dual form, whose steps are
// halved until they help (derivations/filter.md).
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <utility>

#include "slipwise/filter/estimate.hpp"
#include "slipwise/linear/innovation.hpp"

namespace slipwise {

struct MapSettings {
  int iterations;    ///< Gauss-Newton steps at most
  double tolerance;  ///< iterations stop when they lower the MAP cost (in units of NIS) by less than this [-]
  int halvings;      ///< of a step, before it is given up
};

/// A Measurement linearises itself with `at(state)`, and may with `near(state, step, before)`, a step away from where
/// it was linearised `before`; of that, `innovation` is measured minus predicted, `jacobian` the prediction's by the
/// state, and `noise` the covariance of what adds to it. The state is kept as prior + P dual, so that the prior's cost
/// needs no inverse of P, which may be singular.
template <class Measurement>
class MapUpdate {
 public:
  using At = Measurement::At;
  using Innovation = Measurement::Innovation;

  struct Point {
    Eigen::VectorXd dual;
    Eigen::VectorXd state;
    At at;
    Innovation innovation;
    double cost;
  };

  MapUpdate(const Estimate& prior, const Measurement& measurement) : prior_(prior), measurement_(measurement) {}

  /// The prior's mean, where the measurement is linearised `at`.
  Point begin(At at) const { return evaluated(Eigen::VectorXd::Zero(prior_.mean.size()), prior_.mean, std::move(at)); }

  /// Steps until they gain little. False when not even the first one helps.
  bool minimize(Point& point, const MapSettings& settings) const {
    for (int steps = 0; steps < settings.iterations; ++steps) {
      const Eigen::VectorXd full = gauss_newton_dual(point) - point.dual;
      if (steps > 0 && predicted(point, full) < settings.tolerance) {
        break;
      }
      const double before = point.cost;
      if (!descend(point, full, settings.halvings)) {
        return steps > 0;
      }
      if (before - point.cost < settings.tolerance) {
        break;
      }
    }
    return true;
  }

 private:
  static constexpr double kNegligibleCost = 1e-9;  // in squared sigmas: the rounding of a perfect fit is no uphill step

  Point evaluated(Eigen::VectorXd dual, Eigen::VectorXd state, At at) const {
    const Innovation r = measurement_.innovation(at);
    const double cost = dual.dot(state - prior_.mean) + normalised_square(r, measurement_.noise(at));
    return {std::move(dual), std::move(state), std::move(at), r, cost};
  }

  Point evaluate(Eigen::VectorXd dual, const Point& before) const {
    Eigen::VectorXd state = prior_.mean + prior_.covariance * dual;
    At at = linearised(state, before);
    return evaluated(std::move(dual), std::move(state), std::move(at));
  }

  At linearised(const Eigen::VectorXd& state, const Point& before) const {
    if constexpr (requires { measurement_.near(state, state, before.at); }) {
      return measurement_.near(state, state - before.state, before.at);
    } else {
      return measurement_.at(state);
    }
  }

  /// x_{i+1} = x- + K_i [z - h(x_i) - H_i (x- - x_i)], as a dual vector.
  Eigen::VectorXd gauss_newton_dual(const Point& i) const {
    const auto& jacobian = measurement_.jacobian(i.at);
    const auto s = innovation_covariance(prior_.covariance, jacobian, measurement_.noise(i.at));
    const Innovation left = i.innovation - jacobian * (prior_.mean - i.state);
    return jacobian.transpose() * solve_innovation(s, left);
  }

  /// What a step in dual coordinates lowers the cost by, were the measurement linear.
  double predicted(const Point& i, const Eigen::VectorXd& step) const {
    const Eigen::VectorXd moved = prior_.covariance * step;
    const Innovation observed = measurement_.jacobian(i.at) * moved;
    return step.dot(moved) + normalised_square(observed, measurement_.noise(i.at));
  }

  /// Goes a step, or half of it and so on while the MAP cost grows. False when nothing helps.
  bool descend(Point& i, const Eigen::VectorXd& full, int halvings) const {
    for (double fraction = 1.0; halvings >= 0; --halvings, fraction /= 2.0) {
      Point next = evaluate(i.dual + fraction * full, i);
      if (std::isfinite(next.cost) && next.cost <= i.cost * (1.0 + 1e-12) + kNegligibleCost) {
        i = std::move(next);
        return true;
      }
    }
    return false;
  }

  const Estimate& prior_;
  const Measurement& measurement_;
};

}  // namespace slipwise
