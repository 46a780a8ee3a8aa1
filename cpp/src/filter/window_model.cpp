// SPDX-License-Identifier: Apache-2.0
// The MAP update of a model's start, and conditioning of its end.
#include "slipwise/filter/window_model.hpp"

#include <utility>

#include "slipwise/filter/map_update.hpp"
#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/innovation.hpp"

namespace slipwise {
namespace {

/// What a model measures on its way.
struct MeasuredWindow {
  using At = WindowModel;
  using Innovation = Eigen::VectorXd;

  const MeasurementFunction& predict;
  const Eigen::VectorXd& measured;

  At at(const Eigen::VectorXd& state) const { return predict(state); }
  Innovation innovation(const At& at) const { return measured - at.observed(); }
  static auto jacobian(const At& at) { return at.observed_jacobian(); }
  static auto noise(const At& at) { return at.observed_noise(); }
};

}  // namespace

Eigen::MatrixXd innovation_covariance(const Estimate& prior, const WindowModel& at) {
  return innovation_covariance(prior.covariance, at.observed_jacobian(), at.observed_noise());
}

WindowPoint most_probable_start(const Estimate& prior, WindowModel expected, const MeasurementFunction& predict,
                                const Eigen::VectorXd& measured, const IekfSettings& settings) {
  const MeasuredWindow model{predict, measured};
  const MapUpdate problem(prior, model);
  auto now = problem.begin(std::move(expected));
  problem.minimize(now, settings.map());
  return {std::move(now.state), std::move(now.at)};
}

Eigen::MatrixXd start_covariance(const Estimate& prior, const WindowModel& at) {
  const Eigen::MatrixXd spread = at.observed_jacobian() * prior.covariance;
  return prior.covariance - spread.transpose() * Cholesky(innovation_covariance(prior, at)).solve(spread);
}

Estimate end_estimate(const Estimate& prior, const WindowPoint& point, const Eigen::VectorXd& measured) {
  const WindowModel& at = point.at;
  const Eigen::Index n = prior.mean.size();
  const Eigen::MatrixXd& h = at.derivative.topRows(at.measured);
  const Eigen::MatrixXd& a = at.derivative.bottomRows(n);
  const Eigen::MatrixXd cross = a * prior.covariance * h.transpose() + at.noise.bottomLeftCorner(n, at.measured);
  const Eigen::MatrixXd gain = Cholesky(innovation_covariance(prior, at)).solve(cross.transpose()).transpose();
  Eigen::MatrixXd mixed(n, at.measured + n);  // of the noise, what reaches the estimate
  mixed << -gain, Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd keep = a - gain * h;
  const Eigen::MatrixXd covariance = keep * prior.covariance * keep.transpose() + mixed * at.noise * mixed.transpose();
  const Eigen::VectorXd away = prior.mean - point.state;
  return {at.value.tail(n) + a * away + gain * (measured - at.observed() - h * away),
          (covariance + covariance.transpose()) / 2.0};
}

}  // namespace slipwise
