// SPDX-License-Identifier: Apache-2.0
// Scoring predictions of segments.
#include "slipwise/filter/predictive_score.hpp"

#include "slipwise/filter/rows_of_positions.hpp"
#include "slipwise/linear/innovation.hpp"

namespace slipwise {

ScoredSegment PredictiveScore::score(const MotionModel& model, const Estimate& estimate, const InputHistory& inputs,
                                     const Segment& segment) {
  const auto at = linearize_segment(model, estimate.mean, inputs, segment);
  const RowsCovariance open = at.by_parameter * estimate.covariance * at.by_parameter.transpose();
  const RowsCovariance expected = expected_noise(at.path, at.predicted, settings_.shape);
  const RowsCovariance covariance = open + scaled_covariance(expected, scale_for(at.path, noise_scale_.value()));
  const Rows innovation = error_of(segment, at);
  if (shows_noise(segment)) {
    const RowErrors shown{innovation.cwiseAbs2(), open.diagonal(), expected.diagonal()};
    noise_scale_.learn_prediction(at.path.directions(), alike_of_positions(segment.measured, shown));
  }
  return {innovation, covariance, normalised_square(innovation, covariance)};
}

}  // namespace slipwise
