// SPDX-License-Identifier: Apache-2.0
// Gauss-Newton over the start of a passage, and conditioning of its end.
#include "slipwise/estimate/passage.hpp"

#include <cmath>
#include <utility>

#include "slipwise/linear/cholesky.hpp"

namespace slipwise {
namespace {

constexpr double kNegligibleCost = 1e-9;  // in squared sigmas

/// As in the IEKF, the state is prior + P dual, so that P may be singular.
struct Iterate {
  Eigen::VectorXd dual;
  PassagePoint point;
  double cost;
};

Iterate evaluated(const Estimate& prior, PassagePoint point, const Eigen::VectorXd& measured, Eigen::VectorXd dual) {
  const Eigen::VectorXd away = prior.covariance * dual;
  const Eigen::VectorXd r = measured - point.at.seen();
  const double cost = dual.dot(away) + r.dot(Cholesky(point.at.seen_noise()).solve(r));
  return {std::move(dual), std::move(point), cost};
}

Iterate evaluate(const Estimate& prior, const Foretell& foretell, const Eigen::VectorXd& measured,
                 Eigen::VectorXd dual) {
  const Eigen::VectorXd state = prior.mean + prior.covariance * dual;
  return evaluated(prior, {state, foretell(state)}, measured, std::move(dual));
}

Eigen::VectorXd gauss_newton_dual(const Estimate& prior, const Iterate& i, const Eigen::VectorXd& measured) {
  const Passage& at = i.point.at;
  const Eigen::VectorXd left = measured - at.seen() - at.seen_slope() * (prior.mean - i.point.state);
  return at.seen_slope().transpose() * Cholesky(innovation_covariance(prior, at)).solve(left);
}

}  // namespace

Eigen::MatrixXd innovation_covariance(const Estimate& prior, const Passage& at) {
  return at.seen_slope() * prior.covariance * at.seen_slope().transpose() + at.seen_noise();
}

PassagePoint settle(const Estimate& prior, Passage expected, const Foretell& foretell, const Eigen::VectorXd& measured,
                    const IekfSettings& settings) {
  Iterate now = evaluated(prior, {prior.mean, std::move(expected)}, measured, Eigen::VectorXd::Zero(prior.mean.size()));
  for (int steps = 0; steps < settings.iterations; ++steps) {
    const double before = now.cost;
    const Eigen::VectorXd full = gauss_newton_dual(prior, now, measured) - now.dual;
    bool better = false;
    double share = 1.0;
    for (int halvings = settings.halvings; halvings >= 0 && !better; --halvings, share /= 2.0) {
      Iterate next = evaluate(prior, foretell, measured, now.dual + share * full);
      better = std::isfinite(next.cost) && next.cost <= now.cost + kNegligibleCost;
      if (better) {
        now = std::move(next);
      }
    }
    if (!better || before - now.cost < settings.tolerance) {
      break;
    }
  }
  return std::move(now.point);
}

Eigen::MatrixXd start_covariance(const Estimate& prior, const Passage& at) {
  const Eigen::MatrixXd spread = at.seen_slope() * prior.covariance;
  return prior.covariance - spread.transpose() * Cholesky(innovation_covariance(prior, at)).solve(spread);
}

Estimate end_estimate(const Estimate& prior, const PassagePoint& point, const Eigen::VectorXd& measured) {
  const Passage& at = point.at;
  const Eigen::Index n = prior.mean.size();
  const Eigen::MatrixXd& h = at.slope.topRows(at.measured);
  const Eigen::MatrixXd& a = at.slope.bottomRows(n);
  const Eigen::MatrixXd cross = a * prior.covariance * h.transpose() + at.noise.bottomLeftCorner(n, at.measured);
  const Eigen::MatrixXd gain = Cholesky(innovation_covariance(prior, at)).solve(cross.transpose()).transpose();
  Eigen::MatrixXd mixed(n, at.measured + n);  // of the noise, what reaches the estimate
  mixed << -gain, Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd keep = a - gain * h;
  const Eigen::MatrixXd covariance = keep * prior.covariance * keep.transpose() + mixed * at.noise * mixed.transpose();
  const Eigen::VectorXd away = prior.mean - point.state;
  return {at.value.tail(n) + a * away + gain * (measured - at.seen() - h * away),
          (covariance + covariance.transpose()) / 2.0};
}

}  // namespace slipwise
