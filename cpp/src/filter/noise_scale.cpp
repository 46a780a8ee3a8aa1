// SPDX-License-Identifier: Apache-2.0
// The running mean of squared residuals over their expected size.
#include "slipwise/filter/noise_scale.hpp"

#include <algorithm>

#include "slipwise/filter/rows_of_positions.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kLeastFraction, 0.1);  // of a squared error that is noise, however much the parameters leave open

}  // namespace

void NoiseScale::learn(const SegmentLinearization& at, const Eigen::MatrixXd& covariance, const Segment& segment,
                       const Rows& expected) {
  if (!settings_.adapt) {
    return;
  }
  const RowsCovariance open = at.by_parameter * covariance * at.by_parameter.transpose();
  const Rows squared = error_of(segment, at).cwiseAbs2() + open.diagonal();
  follow(at.path.directions(), alike_of_positions(segment.measured, squared, expected), expected);
}

void NoiseScale::learn_prediction(const Directions& directions, const RowErrors& shown) {
  if (settings_.adapt) {
    follow(directions, (shown.squared - shown.open).cwiseMax(kLeastFraction * shown.squared), shown.expected);
  }
}

/// A direction that no row has stays as it is; of several rows, their mean counts.
void NoiseScale::follow(const Directions& directions, const Rows& squared, const Rows& expected) {
  segments_ += 1.0;
  const double gain = std::max(1.0 / (segments_ + settings_.prior_segments), 1.0 / settings_.forgetting_time);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d rows = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < directions.size(); ++i) {
    sum[directions[i]] += squared[i] / expected[i];
    rows[directions[i]] += 1.0;
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (rows[i] > 0.0) {
      value_[i] += gain * (std::min(sum[i] / rows[i], settings_.largest * value_[i]) - value_[i]);
    }
  }
}

}  // namespace slipwise
