// SPDX-License-Identifier: Apache-2.0
// Structures that predict each segment before they learn it.
#include "slipwise/hypotheses/motion_hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "slipwise/linear/present.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kPatience, 0.3);     // of the bases' learning rate: what tells structures apart repeats in each segment
SLIPWISE_TUNING(kDirectPrior, 1.4);  // prior weights, others having 1: of what predicts alike, the simplest
SLIPWISE_TUNING(kBaselinePrior, 2.0);  // the same
SLIPWISE_TUNED std::array<double, kStructures> kPrior{1.0, 1.0, 1.0, kDirectPrior, kBaselinePrior};
SLIPWISE_TUNING(kRefutedOdds, 1e3);
constexpr double kFavoured = 0.9;                // weight of the structure that was the best before
const double kRefuted = std::log(kRefutedOdds);  // tempered log odds against a structure from which on it is dropped

std::size_t index(Structure structure) { return static_cast<std::size_t>(structure); }

/// What these miss must not pass for noise.
bool is_simple(Structure structure) { return structure == Structure::Direct || structure == Structure::Baseline; }

const MotionModel& baseline_model() {
  static const MotionModel model({"none", {}, {}, {}}, {});
  return model;
}

/// Places of the two bases with the fewest terms and of the one with the most.
std::vector<Eigen::Index> few_bases(const std::vector<Basis>& bases) {
  std::vector<Eigen::Index> by_size(bases.size());
  std::iota(by_size.begin(), by_size.end(), Eigen::Index{0});
  std::ranges::stable_sort(by_size, {}, [&](Eigen::Index i) { return bases[static_cast<std::size_t>(i)].size(); });
  std::vector<Eigen::Index> few{by_size.front(), by_size[std::min<std::size_t>(1, by_size.size() - 1)], by_size.back()};
  std::ranges::sort(few);
  few.erase(std::ranges::unique(few).begin(), few.end());
  return few;
}

std::vector<Basis> chosen(const std::vector<Basis>& bases, const std::vector<Eigen::Index>& places) {
  std::vector<Basis> few;
  for (const Eigen::Index place : places) {
    few.push_back(bases[static_cast<std::size_t>(place)]);
  }
  return few;
}

}  // namespace

std::vector<Basis> averaged_bases() {
  std::vector<Basis> bases{{"none", {}, {}, {}}};
  for (const auto* name : {"edd-2", "drive-5", "full-linear-6", "ipem-9", "odd-even-10"}) {
    bases.push_back(named_basis(name));
  }
  return bases;
}

MotionHypotheses::MotionHypotheses(const HypothesisSettings& settings)
    : settings_(settings),
      joint_(ModelAverage("auto", settings.bases,
                          {.dynamics = settings.dynamics,
                           .clock_offset = settings.clock_offset && !settings.dynamics,
                           .sensor_extrinsics = settings.sensor_extrinsics,
                           .lags = !settings.dynamics,
                           .wheelbase = settings.dynamics ? settings.wheelbase : 0.0},
                          settings.filter, settings.average)),
      baseline_(settings.filter.noise),
      bank_(settings.average.surfaces) {
  const auto attempt = [&](Structure structure) { tried_.add(structure, kPrior[index(structure)]); };
  attempt(Structure::Joint);
  if (settings.direct && settings.dynamics) {
    attempt(Structure::Direct);
    direct_bases_ = few_bases(settings.bases);
    direct_.emplace(ModelAverage(
        "auto", chosen(settings.bases, direct_bases_),
        ActuatorParameters{
            .sensor_extrinsics = settings.sensor_extrinsics, .delays = true, .wheelbase = settings.wheelbase},
        settings.filter, settings.average));
  }
  if (settings.baseline) {
    attempt(Structure::Baseline);
  }
  if (settings.cascaded && settings.dynamics) {
    cascaded_.emplace(RememberingAverage(ModelAverage("auto", settings.bases,
                                                      {.clock_offset = settings.clock_offset,
                                                       .sensor_extrinsics = settings.sensor_extrinsics,
                                                       .lags = settings.clock_offset},
                                                      settings.filter, settings.average)),
                      settings.filter, settings.wheelbase);
  }
  tried_.normalise();
}

std::array<double, kStructures> MotionHypotheses::weights() const {
  std::array<double, kStructures> all{};
  for (std::size_t i = 0; i < tried_.size(); ++i) {
    all.at(index(tried_[i])) = tried_.weights()[static_cast<Eigen::Index>(i)];
  }
  return all;
}

/// Where wheel speeds come beside the commands, with the weight that it would have had from the start.
void MotionHypotheses::join_cascade() {
  std::vector<std::size_t> order(tried_.size() + 1);
  std::iota(order.begin(), order.end(), 0);
  std::rotate(order.begin() + 1, order.end() - 1, order.end());  // behind the joint model, which is the first
  tried_.join(Structure::Cascaded, kPrior[index(Structure::Cascaded)], tried_.evidence()[0]);
  tried_ = tried_.chosen(order);
  if (begun_with_ == Structure::Cascaded) {
    favour_known();
  }
}

/// What was the best before begins as such, once it is tried.
void MotionHypotheses::favour_known() {
  if (begun_with_ && tried(*begun_with_)) {
    tried_.favour(tried_.place_of(*begun_with_), kFavoured);
  }
}

void MotionHypotheses::start_slip(const DrivenSegment& segment) {
  if (cascaded_) {
    cascaded_->start_slip(segment);
  }
}

bool MotionHypotheses::advance_slip() { return cascaded_ && cascaded_->advance_slip(); }

/// What is due soonest comes first.
bool MotionHypotheses::refit_slice() {
  return (cascaded_ && cascaded_->refit_slice()) || joint_.average().refit_slice() ||
         (tried(Structure::Direct) && direct_ && direct_->average().refit_slice());
}

void MotionHypotheses::learn_actuator(const WheelSegment& segment) {
  if (cascaded_) {
    cascaded_->learn_actuator(segment);
  }
}

void MotionHypotheses::take(const SlipCue& cue) {
  for (RememberingAverage* average : averages_of(*this)) {
    if (average != nullptr) {
      average->average().take(cue);
    }
  }
}

void MotionHypotheses::start(const DrivenSegment& segment, bool wheels_known) {
  if (cascaded_ && wheels_known && !tried(Structure::Cascaded)) {
    join_cascade();
  }
  segment_ = segment;
  to_predict_ = tried_.keys();
  predicted_.clear();
  std::ranges::for_each(updates_, [](StructureUpdate& update) { update.refitted = false; });
}

bool MotionHypotheses::advance() {
  if (!segment_) {
    return false;
  }
  if (predicted_.size() == to_predict_.size()) {
    bank_.see(present(segment_).inputs, present(segment_).segment);
    update_weights();
    drop_refuted();
    ++count_;
    segment_.reset();
    return false;
  }
  const Structure structure = to_predict_[predicted_.size()];
  RememberingAverage* average = average_of(structure);
  if (average == nullptr) {
    predicted_.push_back(predict(structure));
  } else if (!averaging_) {
    average->start(present(segment_).inputs, present(segment_).segment);
    averaging_ = true;
  } else if (!average->advance()) {
    predicted_.push_back(learned(average->average(), structure));
    averaging_ = false;
  }
  return true;
}

/// What learns the segments themselves.
RememberingAverage* MotionHypotheses::average_of(Structure structure) {
  if (structure == Structure::Joint) {
    return &joint_;
  }
  return structure == Structure::Direct && direct_ ? &*direct_ : nullptr;
}

/// Predicts the segment by the estimate from elsewhere, or not at all.
ScoredSegment MotionHypotheses::predict(Structure structure) {
  const Estimate nothing{Eigen::VectorXd(0), Eigen::MatrixXd(0, 0)};
  const ScoredSegment scored =
      structure == Structure::Cascaded && cascaded_
          ? cascaded_->predict(present(segment_))
          : baseline_.score(baseline_model(), nothing, present(segment_).inputs, present(segment_).segment);
  updates_[index(structure)].nis = scored.nis;
  return scored;
}

ScoredSegment MotionHypotheses::learned(const ModelAverage& average, Structure structure) {
  const IekfUpdate& update = average.update();
  updates_[index(structure)] = {
      .nis = update.nis, .weight = update.weight, .change = average.change(), .refitted = average.refitted()};
  return {update.innovation, update.innovation_covariance, update.nis};
}

/// By their errors, as bases are, under what those miss that could explain most.
void MotionHypotheses::update_weights() {
  if (cascaded_ && tried(Structure::Cascaded)) {
    cascaded_->refresh();
    updates_[index(Structure::Cascaded)].change = cascaded_->change();
    updates_[index(Structure::Cascaded)].refitted = cascaded_->refitted();
  }
  Eigen::VectorXd full = tried_.weights();
  for (std::size_t i = 0; i < tried_.size(); ++i) {
    full[static_cast<Eigen::Index>(i)] *= is_simple(tried_[i]) ? 0.0 : 1.0;
  }
  WeightingSettings weighting = settings_.average.weighting;
  weighting.learning_rate *= kPatience;
  tried_.learn(common_log_scores(full / full.sum(), predicted_), weighting);
}

/// Simpler structures that predict far worse than another.
void MotionHypotheses::drop_refuted() {
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < tried_.size(); ++i) {
    const double behind = tried_.evidence().maxCoeff() - tried_.evidence()[static_cast<Eigen::Index>(i)];
    if (!is_simple(tried_[i]) || !(behind > kRefuted)) {
      left.push_back(i);
    }
  }
  tried_ = tried_.chosen(left);
  tried_.normalise();
}

std::shared_ptr<const MotionPosterior> MotionHypotheses::posterior_of(const ModelAverage& average,
                                                                      Structure structure) const {
  const AverageState state = average.state();
  Eigen::VectorXd weights = state.weights;
  if (structure == Structure::Direct) {
    weights = Eigen::VectorXd::Zero(std::ssize(settings_.bases));
    weights(direct_bases_) = state.weights;
  }
  return std::make_shared<const MotionPosterior>(MotionPosterior{.model = average.model(),
                                                                 .estimate = state.estimate,
                                                                 .prior_std = state.prior_std,
                                                                 .noise = settings_.filter.noise.shape,
                                                                 .noise_scale = state.noise_scale,
                                                                 .variance_ratio = state.variance_ratio,
                                                                 .basis_weights = weights,
                                                                 .structure = structure});
}

std::shared_ptr<const MotionPosterior> MotionHypotheses::of(Structure structure) const {
  if (!tried(structure)) {
    return nullptr;
  }
  switch (structure) {
    case Structure::Joint:
      return posterior_of(joint_.average(), structure);
    case Structure::Direct:
      return posterior_of(present(direct_).average(), structure);
    case Structure::Cascaded:
      return present(cascaded_).posterior();
    default:
      break;
  }
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(std::ssize(settings_.bases));
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    weights[i] = settings_.bases[static_cast<std::size_t>(i)].name() == "none" ? 1.0 : 0.0;
  }
  const Eigen::VectorXd none(0);
  return std::make_shared<const MotionPosterior>(MotionPosterior{.model = baseline_model(),
                                                                 .estimate = {none, Eigen::MatrixXd(0, 0)},
                                                                 .prior_std = none,
                                                                 .noise = settings_.filter.noise.shape,
                                                                 .noise_scale = baseline_.noise_scale(),
                                                                 .variance_ratio = none,
                                                                 .basis_weights = weights,
                                                                 .structure = Structure::Baseline});
}

std::shared_ptr<const MotionPosterior> MotionHypotheses::posterior() const { return of(tried_[tried_.heaviest()]); }

std::shared_ptr<const MotionPosterior> MotionHypotheses::slip_posterior() const {
  std::array<double, kStructures> slipping = weights();
  slipping[index(Structure::Baseline)] = 0.0;
  return of(static_cast<Structure>(std::ranges::max_element(slipping) - slipping.begin()));
}

}  // namespace slipwise
