// SPDX-License-Identifier: Apache-2.0
// The least standard deviation of a clock offset, and what it says of the poses.
#include "slipwise/online/stamp_spacing.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "slipwise/filter/base_link_model.hpp"

namespace slipwise {
namespace {

constexpr double kShows = 0.05;  // [s] of a lag, at least
constexpr double kSure = 2.0;    // standard deviations

}  // namespace

std::shared_ptr<const MotionPosterior> supported(std::shared_ptr<const MotionPosterior> posterior, double seconds,
                                                 std::size_t segments) {
  const auto found = posterior == nullptr || segments == 0 ? std::nullopt : place_of_offset(posterior->model);
  if (!found) {
    return posterior;
  }
  const Eigen::Index place = *found;
  const double least = seconds / std::sqrt(12.0 * static_cast<double>(segments));
  const double std = std::sqrt(posterior->estimate.covariance(place, place));
  if (!(std > 0.0) || !(std < least)) {
    return posterior;
  }
  MotionPosterior wider = *posterior;
  const double factor = least / std;
  wider.estimate.covariance.row(place) *= factor;
  wider.estimate.covariance.col(place) *= factor;
  wider.variance_ratio[place] *= factor * factor;
  return std::make_shared<const MotionPosterior>(std::move(wider));
}

PoseLateness pose_lateness(const MotionPosterior& posterior, double seconds) {
  const std::optional<Eigen::Index> place = place_of_offset(posterior.model);
  if (!place || posterior.variance_ratio.size() == 0 || !(posterior.variance_ratio[*place] <= kUnidentifiableRatio)) {
    return {};
  }
  const auto late = learned_lateness(posterior.model, posterior.estimate, seconds);
  return late && late->mean > 0.0 ? *late : PoseLateness{};
}

bool lag_shows(double log_mean, double log_std) { return std::exp(log_mean - kSure * log_std) > kShows; }

std::optional<PoseLateness> learned_lateness(const MotionModel& model, const Estimate& estimate, double seconds) {
  const std::optional<Eigen::Index> clock = place_of_offset(model);
  if (!clock) {
    return std::nullopt;
  }
  const double spacing = std::isfinite(seconds) ? seconds : 0.0;
  const double held = model.learned().response ? 0.0 : spacing / 2.0;
  double mean = estimate.mean[*clock] + held;
  Eigen::VectorXd by = Eigen::VectorXd::Unit(model.size(), *clock);
  const Eigen::Index lags = model.slip_size();  // of speed and yaw rate, where there are any
  const auto shows = [&](Eigen::Index i) { return lag_shows(estimate.mean[i], std::sqrt(estimate.covariance(i, i))); };
  if (model.learned().lags && !shows(lags) && !shows(lags + 1)) {
    by.segment<2>(lags) = lateness_of_lags(model, estimate.mean);
    mean += by.segment<2>(lags).sum();
  }
  const double variance = by.dot(estimate.covariance * by) + spacing * spacing / 12.0;
  return PoseLateness{.mean = mean, .std = std::sqrt(std::max(variance, 0.0))};
}

}  // namespace slipwise
