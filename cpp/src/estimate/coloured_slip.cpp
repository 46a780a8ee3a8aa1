// SPDX-License-Identifier: Apache-2.0
// A bank of small Kalman filters over the deviation of slip from what was learned (derivations.md, section 18).
#include "slipwise/estimate/coloured_slip.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/estimate/causal_filter.hpp"
#include "slipwise/lie/angle.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise {
namespace {

SeenSlip see(const MotionPosterior& belief, const WanderingTerms& terms, const DrivenSegment& driven) {
  const auto& [inputs, segment, known_at] = driven;
  const auto at = linearize_slip(belief.model, belief.estimate.mean, inputs, segment);
  Eigen::Vector3d innovation = segment.measured.vector() - at.predicted.vector();
  innovation.z() = wrap_angle(innovation.z());
  return {segment.start, segment.end, innovation,
          segment_noise(at.path, at.predicted, belief.noise, belief.noise_scale),
          at.by_parameter(Eigen::all, terms.places)};
}

std::vector<SeenSlip> see_all(const MotionPosterior& belief, const WanderingTerms& terms,
                              std::span<const DrivenSegment> segments) {
  std::vector<SeenSlip> seen;
  for (const DrivenSegment& segment : segments) {
    seen.push_back(see(belief, terms, segment));
  }
  return seen;
}

SlipDeviation followed(const SlipWander& wander, const WanderingTerms& terms, std::span<const SeenSlip> recent) {
  SlipDeviation deviation(wander, terms);
  for (const SeenSlip& seen : recent) {
    deviation.follow(seen);
  }
  return deviation;
}

void check_fits(const SlipNow& now, const WanderLaw& law, const WanderingTerms& terms) {
  const std::size_t expected = terms.places.empty() ? 0 : law.candidates.size();
  const bool same_terms = std::ranges::all_of(
      now.of_candidates, [&](const SlipDeviation& deviation) { return deviation.size() == terms.size(); });
  if (now.of_candidates.size() != expected || !same_terms) {
    throw std::invalid_argument("where slip is now belongs to another model: it must come from the same law and basis");
  }
}

void check_positive(const std::vector<double>& values, const char* what) {
  if (values.empty()) {
    throw std::invalid_argument(std::string(what) + " of coloured slip must not be empty");
  }
  for (const double value : values) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      throw std::invalid_argument(std::string(what) + " of coloured slip must be positive and finite, got " +
                                  std::to_string(value));
    }
  }
}

}  // namespace

ColouredSlip::ColouredSlip(const ColouredSlipSettings& settings) : weighing_(settings.weighing) {
  check_positive(settings.fractions, "the fractions");
  check_positive(settings.time_constants, "the time constants");
  law_.candidates.push_back({0.0, 0.0, 1.0});
  std::vector<double> fractions = settings.fractions;
  fractions.insert(fractions.begin(), 0.0);
  for (const double time_constant : settings.time_constants) {
    for (const double drift : fractions) {
      for (const double turn : fractions) {
        if (drift > 0.0 || turn > 0.0) {
          law_.candidates.push_back({drift, turn, time_constant});
        }
      }
    }
  }
  const auto count = static_cast<Eigen::Index>(law_.candidates.size());
  prior_ = Eigen::VectorXd::Constant(count, (1.0 - settings.white) / static_cast<double>(count - 1));
  prior_[0] = settings.white;
  law_.weights = prior_;
}

ColouredSlip::ColouredSlip(WanderLaw law) : law_(std::move(law)) {
  check_wander(law_);
  prior_ = law_.weights;
}

void ColouredSlip::learn(const MotionPosterior& belief, const SlipNow& now, const DrivenSegment& segment) {
  const WanderingTerms terms = wandering_terms(belief.model, belief.prior_std);
  check_fits(now, law_, terms);
  if (terms.places.empty()) {
    return;
  }
  const SeenSlip next = see(belief, terms, segment);
  Eigen::VectorXd scores(law_.weights.size());
  for (std::size_t i = 0; i < law_.candidates.size(); ++i) {
    const auto deviation = now.of_candidates[i].mean_over(next.start, next.end).first;
    const Eigen::Vector3d innovation = next.innovation - next.by_deviation * deviation;
    const double nis = normalised_square(innovation, next.noise);
    scores[static_cast<Eigen::Index>(i)] = student_log_score(nis, next.noise);  // judged by errors, as bases are
  }
  law_.weights = reweighed(law_.weights, scores, prior_, weighing_, seen_);
  ++seen_;
}

SlipNow ColouredSlip::now(const MotionPosterior& belief, std::span<const DrivenSegment> recent) const {
  const WanderingTerms terms = wandering_terms(belief.model, belief.prior_std);
  SlipNow now;
  if (terms.places.empty() || law_.candidates.empty()) {
    return now;
  }
  const std::vector<SeenSlip> seen = see_all(belief, terms, recent);
  for (const SlipWander& wander : law_.candidates) {
    now.of_candidates.push_back(followed(wander, terms, seen));
  }
  return now;
}

ExpectedPose ColouredSlip::predict(const MotionPosterior& belief, const SlipNow& now,
                                   const DrivenSegment& driven) const {
  const Segment& segment = driven.segment;
  const auto at = linearize_segment(belief.model, belief.estimate.mean, driven.inputs, segment);
  ExpectedPose expected{at.predicted.vector(),
                        prediction_covariance(at, belief.estimate.covariance, belief.noise, belief.noise_scale)};
  const WanderingTerms terms = wandering_terms(belief.model, belief.prior_std);
  check_fits(now, law_, terms);
  const SeenSlip::ByDeviation h = at.by_parameter(Eigen::all, terms.places);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < now.of_candidates.size(); ++i) {
    const auto [deviation, covariance] = now.of_candidates[i].mean_over(segment.start, segment.end);
    const Eigen::Vector3d shift = h * deviation;
    const double weight = law_.weights[static_cast<Eigen::Index>(i)];
    mean += weight * shift;
    square += weight * (h * covariance * h.transpose() + shift * shift.transpose());
  }
  expected.pose += mean;
  expected.covariance += square - mean * mean.transpose();
  return expected;
}

}  // namespace slipwise
