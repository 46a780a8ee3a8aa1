// SPDX-License-Identifier: Apache-2.0
// batch_fit over what was kept.
#include "slipwise/thesis/batch_estimator.hpp"

#include <optional>
#include <utility>

#include "slipwise/filter/batch.hpp"
#include "slipwise/filter/prior.hpp"

namespace slipwise {

BatchEstimator::BatchEstimator(MotionModel model, Estimate prior, const EstimatorSettings& settings)
    : filter_(std::move(model), prior, settings),
      prior_(std::move(prior)),
      noise_(settings.noise),
      huber_(settings.iekf.huber) {}

IekfUpdate BatchEstimator::learn(const InputHistory& inputs, const Segment& segment) {
  IekfUpdate update = filter_.learn(inputs, segment);
  kept_.push_back({inputs, segment});
  return update;
}

Estimate BatchEstimator::estimate() const {
  if (kept_.empty()) {
    return prior_;
  }
  std::vector<BatchDatum> data;
  data.reserve(kept_.size());
  for (const Kept& kept : kept_) {
    const SegmentPath path = integrate_segment(model(), prior_.mean, kept.inputs, kept.segment);
    data.push_back({kept.inputs, kept.segment, segment_noise(path, rows_of(kept.segment.measured), noise_, scale_)});
  }
  return batch_fit(model(), prior_, data, {.huber = huber_}).estimate;
}

bool BatchEstimator::change_prior(const Eigen::VectorXd& old_std, const Eigen::VectorXd& new_std) {
  std::optional<Estimate> changed = change_slip_prior(prior_, old_std, new_std);
  if (!changed || !filter_.change_prior(old_std, new_std)) {
    return false;
  }
  prior_ = std::move(*changed);
  return true;
}

void BatchEstimator::scale_noise(const Eigen::Vector3d& scale) {
  filter_.scale_noise(scale);
  scale_ = scale;
}

}  // namespace slipwise
