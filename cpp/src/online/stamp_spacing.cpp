// SPDX-License-Identifier: Apache-2.0
// The least standard deviation of a clock offset, and what it says of the poses.
#include "slipwise/online/stamp_spacing.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "slipwise/filter/base_link_model.hpp"

namespace slipwise {
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
  const double spacing = std::isfinite(seconds) ? seconds : 0.0;
  const double held = posterior.model.learned().response ? 0.0 : spacing / 2.0;
  const double mean = posterior.estimate.mean[*place] + held;
  const double variance = posterior.estimate.covariance(*place, *place) + spacing * spacing / 12.0;
  return mean > 0.0 ? PoseLateness{.mean = mean, .std = std::sqrt(variance)} : PoseLateness{};
}

}  // namespace slipwise
