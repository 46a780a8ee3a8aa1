// SPDX-License-Identifier: Apache-2.0
// The chain rule over segments.
#include "slipwise/hypotheses/surface_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "slipwise/filter/heavy_tails.hpp"
#include "slipwise/filter/weighting.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/segment/integrate_segment.hpp"
#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise {

SurfaceEvidence::SurfaceEvidence(const MotionModel& model, SurfaceBelief belief, const DisturbanceModel& law)
    : belief_(std::move(belief)) {
  const DisturbedTerms terms = disturbed_terms(model, belief_.prior_std);
  places_ = terms.places;
  nominal_ = Eigen::VectorXd::Zero(terms.size());
  double weighted = 0.0;
  for (std::size_t i = 0; i < law.candidates.size(); ++i) {
    const Eigen::VectorXd part = law.weights[static_cast<Eigen::Index>(i)] * terms.variances(law.candidates[i]);
    nominal_ += part;
    weighted += part.sum() * law.candidates[i].time_constant;
  }
  time_constant_ = nominal_.sum() > 0.0 ? weighted / nominal_.sum() : 1.0;
  deviation_ = Eigen::VectorXd::Zero(terms.size());
  const Eigen::Index size = model.size();
  covariance_ = Eigen::MatrixXd::Zero(size + terms.size(), size + terms.size());
  covariance_.topLeftCorner(size, size) = belief_.estimate.covariance;
  covariance_.diagonal().tail(terms.size()) = nominal_;
}

/// Of the deviation, with the time since the last segment; all of it where another run begins.
void SurfaceEvidence::decay_to(double t) {
  const double keep = t > time_ ? std::exp(-(t - time_) / time_constant_) : 0.0;
  const Eigen::Index terms = deviation_.size();
  deviation_ *= keep;
  covariance_.rightCols(terms) *= keep;
  covariance_.bottomRows(terms) *= keep;
  covariance_.diagonal().tail(terms) += (1.0 - keep * keep) * nominal_;
  time_ = t;
}

double SurfaceEvidence::add(const MotionModel& model, const InputHistory& inputs, const Segment& segment) {
  decay_to((segment.start + segment.end) / 2.0);
  const auto at = linearize_segment(model, belief_.estimate.mean, inputs, segment);
  const Eigen::Index size = model.size();
  const Eigen::Index terms = deviation_.size();
  Eigen::Matrix<double, 3, Eigen::Dynamic> by_state(3, size + terms);
  by_state.leftCols(size) = at.by_parameter;
  by_state.rightCols(terms) = at.by_parameter(Eigen::all, places_);
  const Eigen::Matrix3d noise = segment_noise(at.path, segment.measured, belief_.noise, belief_.noise_scale);
  const Eigen::Vector3d innovation =
      segment.measured.vector() - at.predicted.vector() - by_state.rightCols(terms) * deviation_;
  const Eigen::Matrix<double, 3, Eigen::Dynamic> spread = by_state * covariance_;
  const Eigen::Matrix3d expected = spread * by_state.transpose() + noise;
  const double nis = normalised_square(innovation, expected);
  const double heavier = std::max(1.0, (kTailDegrees + nis) / (kTailDegrees + 3.0));  // an outlier teaches less
  const Eigen::Matrix3d observed = spread * by_state.transpose() + heavier * noise;
  const Eigen::MatrixX3d gain = kalman_gain(observed, spread);
  const Eigen::VectorXd step = gain * innovation;
  belief_.estimate.mean += step.head(size);
  deviation_ += step.tail(terms);
  covariance_ -= gain * spread;
  covariance_ = ((covariance_ + covariance_.transpose()) / 2.0).eval();
  return student_log_score(nis, expected);
}

}  // namespace slipwise
