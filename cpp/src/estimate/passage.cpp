// SPDX-License-Identifier: Apache-2.0
// The MAP update of a passage's start, and conditioning of its end.
#include "slipwise/estimate/passage.hpp"

#include <utility>

#include "slipwise/estimate/map_update.hpp"
#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/innovation.hpp"

namespace slipwise {
namespace {

/// What a passage measures on its way.
struct MeasuredPassage {
  using At = Passage;
  using Innovation = Eigen::VectorXd;

  const Foretell& foretell;
  const Eigen::VectorXd& measured;

  At at(const Eigen::VectorXd& state) const { return foretell(state); }
  Innovation innovation(const At& at) const { return measured - at.seen(); }
  static auto jacobian(const At& at) { return at.seen_slope(); }
  static auto noise(const At& at) { return at.seen_noise(); }
};

}  // namespace

Eigen::MatrixXd innovation_covariance(const Estimate& prior, const Passage& at) {
  return innovation_covariance(prior.covariance, at.seen_slope(), at.seen_noise());
}

PassagePoint settle(const Estimate& prior, Passage expected, const Foretell& foretell, const Eigen::VectorXd& measured,
                    const IekfSettings& settings) {
  const MeasuredPassage passage{foretell, measured};
  const MapUpdate problem(prior, passage);
  auto now = problem.begin(std::move(expected));
  problem.minimize(now, settings.map());
  return {std::move(now.state), std::move(now.at)};
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
