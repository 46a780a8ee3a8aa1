// SPDX-License-Identifier: Apache-2.0
// The least standard deviation of a clock offset.
#include "slipwise/online/stamp_spacing.hpp"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "slipwise/motion/parameter_block.hpp"

namespace slipwise {

std::shared_ptr<const MotionPosterior> supported(std::shared_ptr<const MotionPosterior> posterior, double seconds,
                                                 std::size_t segments) {
  if (posterior == nullptr || !posterior->model.learned().clock_offset || segments == 0) {
    return posterior;
  }
  const std::vector<ParameterInfo> names = posterior->model.parameters();
  Eigen::Index place = 0;
  while (names[static_cast<std::size_t>(place)].name != "clock_offset") {
    ++place;
  }
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

}  // namespace slipwise
