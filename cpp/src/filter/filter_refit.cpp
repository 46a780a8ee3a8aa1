// SPDX-License-Identifier: Apache-2.0
// The phases of a refit.
#include "slipwise/filter/filter_refit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/linear/present.hpp"
#include "slipwise/linear/tuning.hpp"
#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise {
namespace {

constexpr std::size_t kSlice = 6;   // segments that are linearised at a time, as long as one of them is learned
SLIPWISE_TUNING(kTolerance, 0.03);  // of -2 log posterior: a sixth of a standard deviation

}  // namespace

// NOLINTNEXTLINE(readability-function-size): a model, what was known before and is now, and how it is learned.
FilterRefit::FilterRefit(MotionModel model, Estimate before, NoiseScale noise, FilterState now,
                         const CausalFilterSettings& settings, std::size_t count)
    : model_(std::move(model)),
      before_(std::move(before)),
      noise_before_(std::move(noise)),
      state_(std::move(now)),
      noise_(settings.noise),
      iekf_(settings.iekf),
      count_(count) {}

/// By the rule of the IEKF. From wheels, neighbours share the noise of the pose where they meet; from commands, what is
/// not known of the actuator there is far more.
void FilterRefit::weight(const DrivenSegment& driven) {
  const Segment& segment = driven.segment;
  const Eigen::Vector3d& scale = state_.noise_scale.value();
  auto at = linearize_segment(model_, state_.estimate.mean, driven.inputs, segment);
  const RowsCovariance noise = segment_noise(at.path, rows_of(segment.measured), noise_.shape, scale);
  const Rows innovation = error_of(segment, at);
  const RowsCovariance covariance = innovation_covariance(state_.estimate.covariance, at.by_parameter, noise);
  const double nis = normalised_square(innovation, covariance);
  const double counts = iekf_.weight(nis);
  if (counts == 0.0) {
    last_.reset();
    return;
  }
  RowsCovariance shared;
  if (!model_.learned().dynamics && last_) {
    shared = shared_noise(segment, *last_, noise_.shape, scale);
  }
  data_.push_back({.inputs = driven.inputs, .segment = segment, .noise = noise / counts, .shared = std::move(shared)});
  at_.push_back(std::move(at));
  places_.push_back(done_);
  last_ = segment;
}

void FilterRefit::begin_search() {
  done_ = 0;
  if (data_.empty() || !Cholesky(before_.covariance).positive_definite()) {
    phase_ = Phase::Failed;
    return;
  }
  constexpr double kWeighted = std::numeric_limits<double>::infinity();
  const double expected_cost = 3.0 * static_cast<double>(data_.size());
  const BatchSettings settings{
      .tolerance = kTolerance / expected_cost, .huber = kWeighted, .carry = true, .start = state_.estimate.mean};
  search_.emplace(model_, before_, data_, settings, std::exchange(at_, {}));
  phase_ = Phase::Search;
}

void FilterRefit::end_search() {
  BatchFit fit = std::move(present(search_)).result();
  search_.reset();
  if (fit.status != Status::Converged) {
    phase_ = Phase::Failed;
    return;
  }
  state_.estimate = std::move(fit.estimate);
  state_.noise_scale = noise_before_;
  state_.scores.restart();
  at_ = std::move(fit.at);
  phase_ = Phase::Noise;
}

/// The noise of the segments that are fitted, and of those that the gate rejected.
void FilterRefit::learn_noise(const DrivenSegment& driven) {
  const bool fitted = fitted_ < places_.size() && places_[fitted_] == done_;
  const SegmentLinearization at =
      fitted ? std::move(at_[fitted_]) : linearize_segment(model_, state_.estimate.mean, driven.inputs, driven.segment);
  const RowsCovariance expected = expected_noise(at.path, rows_of(driven.segment.measured), noise_.shape);
  if (shows_noise(driven.segment)) {
    state_.noise_scale.learn(at, state_.estimate.covariance, driven.segment, expected.diagonal());
  }
  if (fitted) {
    state_.scores.add(at, state_.estimate.covariance, driven.segment, data_[fitted_].noise);
    ++fitted_;
  }
}

bool FilterRefit::advance(std::span<const DrivenSegment> segments) {
  if (done(segments.size())) {
    return false;
  }
  ++slices_;
  switch (phase_) {
    case Phase::Weight:
      for (const std::size_t end = std::min(done_ + kSlice, count_); done_ < end; ++done_) {
        weight(segments[done_]);
      }
      if (done_ == count_) {
        begin_search();
      }
      break;
    case Phase::Search:
      if (!present(search_).advance(kSlice)) {
        end_search();
      }
      break;
    case Phase::Noise:
      for (const std::size_t end = std::min(done_ + kSlice, count_); done_ < end; ++done_) {
        learn_noise(segments[done_]);
      }
      phase_ = done_ == count_ ? Phase::Follow : phase_;
      break;
    case Phase::Follow:
      state_.learn(model_, segments[done_].inputs, segments[done_].segment, noise_, iekf_);
      ++done_;
      break;
    case Phase::Failed:
      break;
  }
  return true;
}

std::optional<FilterState> FilterRefit::result() && {
  return phase_ == Phase::Follow ? std::optional(std::move(state_)) : std::nullopt;
}

}  // namespace slipwise
