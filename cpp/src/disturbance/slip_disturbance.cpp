// SPDX-License-Identifier: Apache-2.0
// A bank of small Kalman filters over the deviation of slip from what was learned (derivations/uncertainty.md).
#include "slipwise/disturbance/slip_disturbance.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/filter/causal_filter.hpp"
#include "slipwise/lie/se2.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise {
namespace {

ObservedSlip observed(const MotionPosterior& posterior, const DisturbedTerms& terms, const DrivenSegment& driven) {
  const auto& [inputs, segment, known_at] = driven;
  const auto at = linearize_slip(posterior.model, posterior.estimate.mean, inputs, segment);
  return {segment.start, segment.end, shorter_error_of(segment, at),
          segment_noise(at.path, at.predicted, posterior.noise, posterior.noise_scale),
          at.by_parameter(Eigen::all, terms.places)};
}

void check_fits(const SlipNow& now, std::size_t candidates, const DisturbedTerms& terms) {
  const std::size_t expected = terms.places.empty() ? 0 : candidates;
  const bool same_terms = std::ranges::all_of(
      now.of_candidates, [&](const SlipDeviation& deviation) { return deviation.size() == terms.size(); });
  if (now.of_candidates.size() != expected || !same_terms) {
    throw std::invalid_argument("where slip is now belongs to another model: it must come from the same law and basis");
  }
}

void check_positive(const std::vector<double>& values, const char* what) {
  if (values.empty()) {
    throw std::invalid_argument(std::string(what) + " of the slip disturbance must not be empty");
  }
  for (const double value : values) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      throw std::invalid_argument(std::string(what) + " of the slip disturbance must be positive and finite, got " +
                                  std::to_string(value));
    }
  }
}

}  // namespace

DisturbanceFilter::DisturbanceFilter(const DisturbanceSettings& settings) : weighting_(settings.weighting) {
  check_positive(settings.fractions, "the fractions");
  check_positive(settings.time_constants, "the time constants");
  std::vector<double> fractions = settings.fractions;
  fractions.insert(fractions.begin(), 0.0);
  const std::size_t sizes = fractions.size() * fractions.size() - 1;
  const auto others = static_cast<double>(settings.time_constants.size() * sizes);
  bank_.add({0.0, 0.0, 1.0}, settings.white);
  for (const double time_constant : settings.time_constants) {
    for (const double linear : fractions) {
      for (const double angular : fractions) {
        if (linear > 0.0 || angular > 0.0) {
          bank_.add({linear, angular, time_constant}, (1.0 - settings.white) / others);
        }
      }
    }
  }
}

DisturbanceFilter::DisturbanceFilter(const DisturbanceModel& law) {
  check_disturbance(law);
  for (std::size_t i = 0; i < law.candidates.size(); ++i) {
    bank_.add(law.candidates[i], law.weights[static_cast<Eigen::Index>(i)]);
  }
}

void DisturbanceFilter::begin_with(const DisturbanceModel& law) {
  const auto same = [](const SlipDisturbance& a, const SlipDisturbance& b) {
    return a.linear == b.linear && a.angular == b.angular && a.time_constant == b.time_constant;
  };
  check_disturbance(law);
  if (std::ranges::equal(law.candidates, bank_.keys(), same)) {
    bank_.begin_with(law.weights, bank_.observed());
  }
}

void DisturbanceFilter::learn(const MotionPosterior& posterior, const SlipNow& now, const DrivenSegment& segment) {
  const DisturbedTerms terms = disturbed_terms(posterior.model, posterior.prior_std);
  check_fits(now, bank_.size(), terms);
  if (terms.places.empty()) {
    return;
  }
  const ObservedSlip next = observed(posterior, terms, segment);
  Eigen::VectorXd scores(bank_.weights().size());
  for (std::size_t i = 0; i < bank_.size(); ++i) {
    const auto deviation = now.of_candidates[i].mean_over(next.start, next.end).first;
    const Rows innovation = next.innovation - next.by_deviation * deviation;
    const double nis = normalised_square(innovation, next.noise);
    scores[static_cast<Eigen::Index>(i)] = student_log_score(nis, next.noise);  // judged by errors, as bases are
  }
  bank_.learn(scores, weighting_);
}

SlipNow DisturbanceFilter::now(const MotionPosterior& posterior, std::span<const DrivenSegment> recent) const {
  const DisturbedTerms terms = disturbed_terms(posterior.model, posterior.prior_std);
  SlipNow now;
  if (terms.places.empty()) {
    return now;
  }
  for (const SlipDisturbance& disturbance : bank_.keys()) {
    now.of_candidates.emplace_back(disturbance, terms);
  }
  for (const DrivenSegment& segment : recent) {
    follow(posterior, now, segment);
  }
  return now;
}

void DisturbanceFilter::follow(const MotionPosterior& posterior, SlipNow& now, const DrivenSegment& segment) const {
  const DisturbedTerms terms = disturbed_terms(posterior.model, posterior.prior_std);
  check_fits(now, bank_.size(), terms);
  if (terms.places.empty()) {
    return;
  }
  follow(now, observed(posterior, terms, segment));
}

void DisturbanceFilter::follow(SlipNow& now, const ObservedSlip& seen) {
  for (SlipDeviation& deviation : now.of_candidates) {
    deviation.follow(seen);
  }
}

ObservedSlip DisturbanceFilter::see(const MotionPosterior& posterior, const DrivenSegment& segment) {
  return observed(posterior, disturbed_terms(posterior.model, posterior.prior_std), segment);
}

ExpectedPose DisturbanceFilter::predict(const MotionPosterior& posterior, const SlipNow& now,
                                        const DrivenSegment& segment) const {
  const auto at = linearize_segment(posterior.model, posterior.estimate.mean, segment.inputs, segment.segment);
  return predict_at(posterior, now, at, segment.segment);
}

ExpectedPose DisturbanceFilter::predict_at(const MotionPosterior& posterior, const SlipNow& now,
                                           const SegmentLinearization& at, const Segment& segment) const {
  const DisturbedTerms terms = disturbed_terms(posterior.model, posterior.prior_std);
  check_fits(now, bank_.size(), terms);
  return expected(posterior, now, terms, at, {segment.start, segment.end});
}

std::vector<ExpectedPose> DisturbanceFilter::predict_along(const MotionPosterior& posterior, const SlipNow& now,
                                                           std::span<const SegmentLinearization> beginnings,
                                                           const Segment& segment) const {
  const DisturbedTerms terms = disturbed_terms(posterior.model, posterior.prior_std);
  check_fits(now, bank_.size(), terms);
  std::vector<ExpectedPose> along;
  for (const SegmentLinearization& at : beginnings) {
    const double end = &at == &beginnings.back() ? segment.end : at.path.times.back();
    along.push_back(expected(posterior, now, terms, at, {segment.start, end}));
  }
  return along;
}

ExpectedPoses DisturbanceFilter::predict_both(const MotionPosterior& posterior, const SlipNow& now,
                                              const DrivenSegment& driven) const {
  const auto at = linearize_segment(posterior.model, posterior.estimate.mean, driven.inputs, driven.segment);
  return {.now = predict_at(posterior, now, at, driven.segment),
          .nominal = predict_at(posterior, this->now(posterior, {}), at, driven.segment)};
}

ExpectedDeviation DisturbanceFilter::deviation(const MotionPosterior& posterior, const SlipNow& now,
                                               const std::array<double, 2>& span) const {
  const DisturbedTerms terms = disturbed_terms(posterior.model, posterior.prior_std);
  check_fits(now, bank_.size(), terms);
  ExpectedDeviation found{.places = terms.places,
                          .mean = Eigen::VectorXd::Zero(terms.size()),
                          .covariance = Eigen::MatrixXd::Zero(terms.size(), terms.size())};
  for (std::size_t i = 0; i < now.of_candidates.size(); ++i) {
    const auto [deviation, covariance] = now.of_candidates[i].mean_over(span[0], span[1]);
    const double weight = bank_.weights()[static_cast<Eigen::Index>(i)];
    found.mean += weight * deviation;
    found.covariance += weight * (covariance + deviation * deviation.transpose());
  }
  found.covariance -= found.mean * found.mean.transpose();
  return found;
}

/// Adds the mean of the deviation over a time span, and its covariance, as mixed by the candidates' weights.
ExpectedPose DisturbanceFilter::expected(const MotionPosterior& posterior, const SlipNow& now,
                                         const DisturbedTerms& terms, const SegmentLinearization& at,
                                         const std::array<double, 2>& span) const {
  const auto [start, end] = span;
  const ObservedSlip::ByDeviation h = at.by_parameter(Eigen::all, terms.places);
  Rows mean = Rows::Zero(h.rows());
  RowsCovariance square = RowsCovariance::Zero(h.rows(), h.rows());
  for (std::size_t i = 0; i < now.of_candidates.size(); ++i) {
    const auto [deviation, covariance] = now.of_candidates[i].mean_over(start, end);
    const Rows shift = h * deviation;
    const double weight = bank_.weights()[static_cast<Eigen::Index>(i)];
    mean += weight * shift;
    square += weight * (h * covariance * h.transpose() + shift * shift.transpose());
  }
  const RowsCovariance without =
      prediction_covariance(at, posterior.estimate.covariance, posterior.noise, posterior.noise_scale);
  return {at.predicted + mean, without + square - mean * mean.transpose()};
}

}  // namespace slipwise
