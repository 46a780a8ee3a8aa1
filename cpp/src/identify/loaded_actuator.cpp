// SPDX-License-Identifier: Apache-2.0
// What has to hold of filters of actuators that are loaded.
#include <algorithm>

#include "slipwise/archive/bytes.hpp"
#include "slipwise/archive/same.hpp"
#include "slipwise/identify/actuator_filter.hpp"
#include "slipwise/identify/car_curve_filter.hpp"

namespace slipwise {
namespace {

using archive::require;

bool same_size(const auto& one, const auto& other) { return one.size() == other.size(); }

bool same_sizes(const auto& one, const auto& other) {
  return std::ranges::equal(one, other, [](const auto& a, const auto& b) {
    return a.size() == b.size() && (a.size() == 0 || a.rows() == b.rows());
  });
}

/// Axes of the model, each once.
bool axes_of(const std::vector<std::size_t>& live, const ChannelModel& model) {
  std::vector<std::size_t> sorted = live;
  std::ranges::sort(sorted);
  return std::ranges::adjacent_find(sorted) == sorted.end() && (sorted.empty() || sorted.back() < model.parts.size());
}

/// What was found, and not taken from there since.
bool is_whole(const ChannelRun& run, const ChannelModel& model) {
  return axes_of(run.live, model) && run.joint.mean.size() == kChannelParameters + kAxisStates * std::ssize(run.live);
}

}  // namespace

void ActuatorChannel::check_loaded(const ActuatorChannel& made) const {
  require(model_.parts == made.model_.parts && archive::same(model_.noise, made.model_.noise) &&
              archive::same(model_.iekf, made.model_.iekf) && model_.prior.mean.size() == kChannelParameters,
          "an actuator has another model");
  require(axes_of(live_, model_) && joint_.mean.size() == kChannelParameters + kAxisStates * std::ssize(live_),
          "an actuator follows other axes than it has states");
  require(size_ > 0.0 && windows_ >= 0.0, "an actuator's noise has no size");
}

void ChannelFilter::check_loaded(const ChannelModel& model) const {
  require(model_ && model_->parts == model.parts && model_->prior.mean.size() == kChannelParameters && size_ > 0.0,
          "the walk of an actuator has another model");
  std::vector<std::size_t> live;
  std::ranges::transform(axes_, std::back_inserter(live), &FollowedAxis::place);
  require(axes_of(live, model) && point_.allFinite(), "the walk of an actuator follows other axes");
}

void ChannelFit::check_loaded(const ActuatorChannel& made, std::size_t past) const {
  require(model_ && model_->parts == made.model().parts && model_->prior.mean.size() == kChannelParameters &&
              size_ > 0.0 && search_.has_size(kChannelParameters) && done_ <= past,
          "the fit of an actuator has another model");
  require((best_ || walk_) && (!best_ || (at_best_.gradient.size() == kChannelParameters && is_whole(*best_, *model_))),
          "the fit of an actuator has lost what it found");
  if (walk_) {
    walk_->check_loaded(*model_);
  }
}

void ChannelRefit::check_loaded(const ActuatorChannel& made, std::size_t past) const {
  channel_.check_loaded(made);
  require(model_ && model_->parts == made.model().parts && size_ > 0.0 && count_ <= past && done_ <= past,
          "the refit of an actuator is of windows that are not kept");
  require(!first_ || !fit_ || is_whole(*first_, *model_), "the refit of an actuator has lost its first fit");
  if (fit_) {
    fit_->check_loaded(made, count_);
  }
}

void ActuatorFilter::check_loaded(const ActuatorFilter& made) const {
  require(
      archive::same(model_, made.model_) && same_size(prior_std_, made.prior_std_) && same_size(banks_, made.banks_),
      "an actuator is of another model");
  for (std::size_t i = 0; i < banks_.size(); ++i) {
    const Bank& bank = banks_[i];
    const Bank& other = made.banks_[i];
    require(bank.places == other.places && same_size(bank.candidates, other.candidates) &&
                bank.candidates.weights().maxCoeff() > 0.0 &&
                (bank.refits.empty() || same_size(bank.refits, other.candidates)),
            "a bank of actuators has other candidates");
    for (std::size_t k = 0; k < bank.candidates.size(); ++k) {
      bank.candidates[k].check_loaded(other.candidates[k]);
      if (k < bank.refits.size()) {
        if (const auto& refit = bank.refits[k]) {
          refit->check_loaded(other.candidates[k], past_.size());
        }
      }
    }
  }
  const bool refits = std::ranges::any_of(banks_, [](const Bank& bank) { return !bank.refits.empty(); });
  require(!refits || refitted_after_, "the refit of an actuator never ends");
}

void CurveBank::check_loaded(const CurveBank& made) const {
  require(same_sizes(information_, made.information_) && same_sizes(evidence_, made.evidence_) &&
              same_sizes(weights_, made.weights_) && same_size(squares_, made.squares_) &&
              archive::same(precision_, made.precision_) && archive::same(prior_, made.prior_) && free_ == made.free_,
          "the curves of a car have other weights");
}

void CurveCopies::check_loaded(const CurveCopies& made) const {
  prior_.check_loaded(made.prior_);
  require(copies_.size() > 0 && copies_.weights().maxCoeff() > 0.0, "the curves of a car have no copy");
  for (const CurveBank& copy : copies_.keys()) {
    copy.check_loaded(made.prior_);
  }
}

void RestFilter::check_loaded(const RestFilter& made) const {
  require(same_size(score_, made.score_), "lags of a car are others");
}

void CarCurveFilter::check_loaded(const CarCurveFilter& made) const {
  speed_.check_loaded(made.speed_);
  turn_.check_loaded(made.turn_);
  turn_rest_.check_loaded(made.turn_rest_);
  sideways_.check_loaded(made.sideways_);
  require(ramps_.rows() == made.ramps_.rows() && ramps_.cols() == made.ramps_.cols() &&
              same_size(drags_, made.drags_) && same_size(steering_, made.steering_) &&
              same_size(observers_, made.observers_) && same_size(observer_score_, made.observer_score_),
          "a car is followed by other filters");
}

}  // namespace slipwise
