// SPDX-License-Identifier: Apache-2.0
// The chain rule over segments.
#include "slipwise/hypotheses/surface_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "slipwise/filter/heavy_tails.hpp"
#include "slipwise/filter/linear_update.hpp"
#include "slipwise/filter/weighting.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/linear/tuning.hpp"
#include "slipwise/segment/integrate_segment.hpp"
#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kHardly, 0.02);  // weight below which a candidate of the disturbance is passed over

}  // namespace

SurfaceEvidence::SurfaceEvidence(const MotionModel& model, SurfacePosterior posterior, const DisturbanceModel& law)
    : posterior_(std::move(posterior)) {
  const DisturbedTerms terms = disturbed_terms(model, posterior_.prior_std);
  places_ = terms.places;
  const Eigen::Index size = model.size();
  std::vector<Estimate> starts = std::exchange(posterior_.jumped, {});
  if (starts.empty()) {
    starts.push_back(posterior_.estimate);
  }
  const auto consider = [&](const SlipDisturbance& disturbance, double weight) {
    for (const Estimate& start : starts) {
      Under under{.time_constant = disturbance.time_constant,
                  .nominal = terms.variances(disturbance),
                  .state = Eigen::VectorXd::Zero(size + terms.size()),
                  .covariance = Eigen::MatrixXd::Zero(size + terms.size(), size + terms.size())};
      under.state.head(size) = start.mean - posterior_.estimate.mean;
      under.covariance.topLeftCorner(size, size) = start.covariance;
      under.covariance.diagonal().tail(terms.size()) = under.nominal;
      const double share = weight / static_cast<double>(starts.size());
      under_.add(std::move(under), share, std::log(share));
    }
  };
  for (std::size_t i = 0; i < law.candidates.size(); ++i) {
    const double weight = law.weights[static_cast<Eigen::Index>(i)];
    if (weight >= std::min(kHardly, law.weights.maxCoeff())) {
      consider(law.candidates[i], weight);
    }
  }
  if (under_.size() == 0) {
    consider({.linear = 0.0, .angular = 0.0, .time_constant = 1.0}, 1.0);
  }
}

/// Of the deviation, with the time since the last segment.
void SurfaceEvidence::Under::decay(double seconds) {
  const double keep = std::exp(-seconds / time_constant);
  const Eigen::Index terms = nominal.size();
  state.tail(terms) *= keep;
  covariance.rightCols(terms) *= keep;
  covariance.bottomRows(terms) *= keep;
  covariance.diagonal().tail(terms) += (1.0 - keep * keep) * nominal;
}

double SurfaceEvidence::Under::learn(const Rows& innovation, const RowsJacobian& by_state,
                                     const RowsCovariance& noise) {
  const Rows left = innovation - by_state * state;
  const RowsCovariance expected = innovation_covariance(covariance, by_state, noise);
  const double nis = normalised_square(left, expected);
  const double heavier = std::max(1.0, (kTailDegrees + nis) / (kTailDegrees + 3.0));  // an outlier teaches less
  state += linear_update(covariance, by_state, heavier * noise) * left;
  return student_log_score(nis, expected);
}

double SurfaceEvidence::add(const MotionModel& model, const InputHistory& inputs, const Segment& segment) {
  const double middle = (segment.start + segment.end) / 2.0;
  const double passed = middle > time_ ? middle - time_ : std::numeric_limits<double>::infinity();
  time_ = middle;
  const double before = under_.log_evidence();
  const Eigen::Index size = model.size();
  const Eigen::VectorXd away = under_[under_.heaviest()].state.head(size);
  const auto at = linearize_segment(model, posterior_.estimate.mean + away, inputs, segment);
  RowsJacobian by_state(at.by_parameter.rows(), size + std::ssize(places_));
  by_state.leftCols(size) = at.by_parameter;
  by_state.rightCols(std::ssize(places_)) = at.by_parameter(Eigen::all, places_);
  const RowsCovariance noise =
      segment_noise(at.path, rows_of(segment.measured), posterior_.noise, posterior_.noise_scale);
  const Rows innovation = error_of(segment, at) + at.by_parameter * away;
  Eigen::VectorXd scores(under_.weights().size());
  for (std::size_t i = 0; i < under_.size(); ++i) {
    under_[i].decay(passed);
    scores[static_cast<Eigen::Index>(i)] = under_[i].learn(innovation, by_state, noise);
  }
  under_.weigh(scores);
  return under_.log_evidence() - before;
}

}  // namespace slipwise
