// SPDX-License-Identifier: Apache-2.0
// One update of a causal filter.
#include "slipwise/filter/filter_state.hpp"

#include <utility>

#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise {

FilterState::FilterState(const MotionModel& model, const NoiseSettings& noise)
    : estimate{}, noise_scale(noise), scores(model) {}

IekfUpdate FilterState::learn(const MotionModel& model, const InputHistory& inputs, const Segment& segment,
                              const NoiseSettings& noise, const IekfSettings& iekf) {
  auto at = linearize_segment(model, estimate.mean, inputs, segment);
  const RowsCovariance expected = expected_noise(at.path, rows_of(segment.measured), noise.shape);
  const RowsCovariance scaled = scaled_covariance(expected, scale_for(at.path, noise_scale.value()));
  IekfUpdate update = iekf_update(model, estimate, inputs, segment, std::move(at), scaled, iekf);
  take(update, segment, {.expected = expected, .scaled = scaled});
  return update;
}

void FilterState::take(const IekfUpdate& update, const Segment& segment, const SegmentNoise& noise) {
  estimate = update.estimate;
  if (shows_noise(segment)) {
    noise_scale.learn(update.at, estimate.covariance, segment, noise.expected.diagonal());
  }
  if (update.weight > 0.0) {
    scores.add(update.at, estimate.covariance, segment, noise.scaled / update.weight);
  }
}

}  // namespace slipwise
