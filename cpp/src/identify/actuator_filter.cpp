// SPDX-License-Identifier: Apache-2.0
// Banks of filters, weighted by how well they predict wheel speeds.
#include "slipwise/identify/actuator_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "slipwise/filter/prior.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kInterval, 0.1);  // [s] one measurement
/// White noise alone first; or a deviation that is far larger and lasts for this long.
SLIPWISE_TUNING(kDeviation, 100.0);  // variance of a deviation, over that of one sample
SLIPWISE_TUNED std::array<ActuatorNoise, 5> kShapes{{{.white = 1.0, .deviation = 0.0, .time_constant = 1.0},
                                                     {.white = 1.0, .deviation = kDeviation, .time_constant = 0.2},
                                                     {.white = 1.0, .deviation = kDeviation, .time_constant = 1.0},
                                                     {.white = 1.0, .deviation = kDeviation, .time_constant = 5.0},
                                                     {.white = 1.0, .deviation = kDeviation, .time_constant = 25.0}}};
SLIPWISE_TUNING(kFirst, std::size_t{3});  // windows from which and up to which all are refitted
SLIPWISE_TUNING(kLast, std::size_t{256});
SLIPWISE_TUNING(kInflation, 1.25);  // of their number, until that is done again
SLIPWISE_TUNING(kActive, 0.01);     // weight from which a candidate is refitted and has a say

}  // namespace

ActuatorFilter::ActuatorFilter(const CausalFilterSettings& settings, std::size_t waiting)
    : model_({"none", {}, {}, {}}, {.dynamics = true, .response = true}), next_(std::clamp(waiting, kFirst, kLast)) {
  const Estimate prior = prior_estimate(model_, {.v = 1.0, .omega = 1.0}, settings.prior);
  prior_std_ = prior.covariance.diagonal().cwiseSqrt();
  begin_with(prior, settings);
}

ActuatorFilter::ActuatorFilter(const ActuatorFilter&) = default;
ActuatorFilter::ActuatorFilter(ActuatorFilter&&) noexcept = default;
ActuatorFilter& ActuatorFilter::operator=(const ActuatorFilter&) = default;
ActuatorFilter& ActuatorFilter::operator=(ActuatorFilter&&) noexcept = default;
ActuatorFilter::~ActuatorFilter() = default;

void ActuatorFilter::begin_with(const Estimate& known, const CausalFilterSettings& settings) {
  banks_.clear();
  const auto add = [&](std::vector<Eigen::Index> places, const std::vector<double BodyTwist::*>& parts) {
    const Estimate own{known.mean(places), known.covariance(places, places)};
    Bank bank{.places = std::move(places), .candidates = {}, .refits = {}};
    for (const ActuatorNoise& shape : kShapes) {
      bank.candidates.add(ActuatorChannel(ChannelModel{parts, own, shape, settings.iekf}),
                          1.0 / static_cast<double>(kShapes.size()));
    }
    banks_.push_back(std::move(bank));
  };
  add({0, 2, 4, 6, 8}, {&BodyTwist::v, &BodyTwist::vy});
  add({1, 3, 5, 7, 9}, {&BodyTwist::omega});
}

/// The NIS of the actuator without a deviation. A window that all leave out weighs none of them.
double ActuatorFilter::Bank::learn(const ChannelWindow& window) {
  const Eigen::VectorXd& weights = candidates.weights();
  Eigen::VectorXd scores(weights.size());
  double nis = 0.0;
  bool left_out = true;
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    const ChannelUpdate update = candidates[static_cast<std::size_t>(i)].learn(window, weights[i] > kActive);
    scores[i] = update.log_score;
    nis = i == 0 ? update.nis : nis;
    left_out = left_out && update.status == Status::Rejected;
  }
  if (left_out) {
    candidates.pass();
  } else {
    candidates.learn(scores, WeightingSettings{});
  }
  return nis;
}

void ActuatorFilter::Bank::begin_refit(std::size_t windows) {
  refits.clear();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const bool active = candidates.weights()[static_cast<Eigen::Index>(i)] > kActive;
    refits.push_back(active ? std::optional(ChannelRefit(candidates[i], windows)) : std::nullopt);
  }
}

bool ActuatorFilter::Bank::refit_slice(std::span<const ChannelWindow> past) {
  return std::ranges::any_of(refits, [&](auto& refit) { return refit && refit->advance(past); });
}

void ActuatorFilter::Bank::end_refit() {
  for (std::size_t i = 0; i < refits.size(); ++i) {
    if (const auto& refit = refits[i]; refit) {
      candidates[i] = refit->result();
    }
  }
  refits.clear();
}

/// Mean and covariance of the weighted candidates. One that is as good as refuted has no say: weight is redistributed
/// at each window, and a thousandth of a candidate that knows a gain to 0.03 would hide that the others know it to
/// 0.0003.
Estimate ActuatorFilter::Bank::mixture() const {
  const Eigen::VectorXd& weights = candidates.weights();
  const Eigen::VectorXd active = (weights.array() > kActive).select(weights, 0.0);
  const Eigen::VectorXd normalised = active / active.sum();
  Estimate all{Eigen::VectorXd::Zero(kChannelParameters),
               Eigen::MatrixXd::Zero(kChannelParameters, kChannelParameters)};
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    all.mean += normalised[static_cast<Eigen::Index>(i)] * candidates[i].estimate().mean;
  }
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Estimate own = candidates[i].estimate();
    const Eigen::VectorXd away = own.mean - all.mean;
    all.covariance += normalised[static_cast<Eigen::Index>(i)] * (own.covariance + away * away.transpose());
  }
  return all;
}

ActuatorUpdate ActuatorFilter::learn(const InputHistory& inputs, const InputHistory& wheels, double start, double end) {
  ChannelWindow window{inputs, wheel_means(wheels, start, end, kInterval)};
  ActuatorUpdate update{.nis = 0.0};
  for (Bank& bank : banks_) {
    update.nis += bank.learn(window);
  }
  ++learned_;
  if (learned_ <= kLast || refitted_after_) {
    past_.push_back(std::move(window));
  }
  if (refitted_after_ && learned_ >= *refitted_after_) {
    end_refit();
  }
  if (learned_ >= next_ && learned_ <= kLast && !refitted_after_) {
    next_ = static_cast<std::size_t>(std::ceil(kInflation * static_cast<double>(learned_)));
    refitted_after_ = learned_ + std::max<std::size_t>(1, learned_ / 32);
    for (Bank& bank : banks_) {
      bank.begin_refit(learned_);
    }
  }
  if (learned_ >= kLast && !refitted_after_) {
    past_ = {};
  }
  return update;
}

bool ActuatorFilter::refit_slice() {
  return std::ranges::any_of(banks_, [&](Bank& bank) { return bank.refit_slice(past_); });
}

void ActuatorFilter::end_refit() {
  while (refit_slice()) {
  }
  for (Bank& bank : banks_) {
    bank.end_refit();
  }
  refitted_after_.reset();
}

Estimate ActuatorFilter::estimate() const {
  Estimate all{Eigen::VectorXd(model_.size()), Eigen::MatrixXd::Zero(model_.size(), model_.size())};
  for (const Bank& bank : banks_) {
    const Estimate own = bank.mixture();
    all.mean(bank.places) = own.mean;
    all.covariance(bank.places, bank.places) = own.covariance;
  }
  return all;
}

}  // namespace slipwise
