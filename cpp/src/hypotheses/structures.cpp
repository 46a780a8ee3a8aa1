// SPDX-License-Identifier: Apache-2.0
// Which structures are tried, how they are weighted, and what each knows.
#include "slipwise/hypotheses/structures.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
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

Structures::Structures(const HypothesisSettings& settings)
    : settings_(settings),
      joint_(ModelAverage("auto", settings.bases,
                          {.dynamics = settings.dynamics,
                           .clock_offset = settings.clock_offset && !settings.dynamics,
                           .sensor_extrinsics = settings.sensor_extrinsics,
                           .lags = !settings.dynamics,
                           .wheelbase = settings.dynamics ? settings.wheelbase : 0.0},
                          settings.filter, settings.average)),
      baseline_(settings.filter.noise) {
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

std::vector<std::string> Structures::basis_names(std::size_t average) const {
  const std::vector<Basis> bases = average == kDirect ? chosen(settings_.bases, direct_bases_) : settings_.bases;
  std::vector<std::string> names;
  std::ranges::transform(bases, std::back_inserter(names), &Basis::name);
  return names;
}

std::array<double, kStructures> Structures::weights() const {
  std::array<double, kStructures> all{};
  for (std::size_t i = 0; i < tried_.size(); ++i) {
    all.at(index(tried_[i])) = tried_.weights()[static_cast<Eigen::Index>(i)];
  }
  return all;
}

/// With the weight that it would have had from the start.
bool Structures::join_cascade(bool wheels_known) {
  if (!cascaded_ || !wheels_known || tried(Structure::Cascaded)) {
    return false;
  }
  std::vector<std::size_t> order(tried_.size() + 1);
  std::iota(order.begin(), order.end(), 0);
  std::rotate(order.begin() + 1, order.end() - 1, order.end());  // behind the joint model, which is the first
  tried_.join(Structure::Cascaded, kPrior[index(Structure::Cascaded)], tried_.evidence()[0]);
  tried_ = tried_.chosen(order);
  return true;
}

void Structures::favour(Structure structure) {
  if (tried(structure)) {
    tried_.favour(tried_.place_of(structure), kFavoured);
  }
}

/// What is due soonest comes first.
bool Structures::refit_slice() {
  return (cascaded_ && cascaded_->refit_slice()) || joint_.average().refit_slice() ||
         (tried(Structure::Direct) && direct_ && direct_->average().refit_slice());
}

void Structures::take(const SlipCue& cue) {
  for (RememberingAverage* average : averages_of(*this)) {
    if (average != nullptr) {
      average->average().take(cue);
    }
  }
}

RememberingAverage* Structures::average_of(Structure structure) {
  if (structure == Structure::Joint) {
    return &joint_;
  }
  return structure == Structure::Direct && direct_ ? &*direct_ : nullptr;
}

/// By the estimate from elsewhere, or not at all.
ScoredSegment Structures::score(Structure structure, const DrivenSegment& segment) {
  const Estimate nothing{Eigen::VectorXd(0), Eigen::MatrixXd(0, 0)};
  return structure == Structure::Cascaded && cascaded_
             ? cascaded_->predict(segment)
             : baseline_.score(baseline_model(), nothing, segment.inputs, segment.segment);
}

/// By their errors, as bases are, under what those miss that could explain most.
void Structures::learn(std::span<const ScoredSegment> predicted) {
  Eigen::VectorXd full = tried_.weights();
  for (std::size_t i = 0; i < tried_.size(); ++i) {
    full[static_cast<Eigen::Index>(i)] *= is_simple(tried_[i]) ? 0.0 : 1.0;
  }
  WeightingSettings weighting = settings_.average.weighting;
  weighting.learning_rate *= kPatience;
  tried_.learn(common_log_scores(full / full.sum(), predicted), weighting);
  drop_refuted();
}

/// Simpler structures that predict far worse than another.
void Structures::drop_refuted() {
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

std::shared_ptr<const MotionPosterior> Structures::posterior_of(const ModelAverage& average,
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

std::shared_ptr<const MotionPosterior> Structures::of(Structure structure) const {
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

std::shared_ptr<const MotionPosterior> Structures::slip_posterior() const {
  std::array<double, kStructures> slipping = weights();
  slipping[index(Structure::Baseline)] = 0.0;
  return of(static_cast<Structure>(std::ranges::max_element(slipping) - slipping.begin()));
}

}  // namespace slipwise
