// SPDX-License-Identifier: Apache-2.0
// iekf_update, segment after segment.
#include "slipwise/thesis/iekf_estimator.hpp"

#include <optional>
#include <utility>

#include "slipwise/filter/prior.hpp"

namespace slipwise {

IekfEstimator::IekfEstimator(MotionModel model, Estimate prior, const EstimatorSettings& settings)
    : model_(std::move(model)), settings_(settings.iekf), noise_(settings.noise), estimate_(std::move(prior)) {}

IekfUpdate IekfEstimator::learn(const InputHistory& inputs, const Segment& segment) {
  auto at = linearize_segment(model_, estimate_.mean, inputs, segment);
  const RowsCovariance noise = segment_noise(at.path, rows_of(segment.measured), noise_, scale_);
  IekfUpdate update = iekf_update(model_, estimate_, inputs, segment, std::move(at), noise, settings_);
  estimate_ = update.estimate;
  return update;
}

bool IekfEstimator::change_prior(const Eigen::VectorXd& old_std, const Eigen::VectorXd& new_std) {
  std::optional<Estimate> changed = change_slip_prior(estimate_, old_std, new_std);
  if (!changed) {
    return false;
  }
  estimate_ = std::move(*changed);
  return true;
}

}  // namespace slipwise
