// SPDX-License-Identifier: Apache-2.0
// A model average on surfaces that it knows: they compete, and one is taken (derivations/surfaces.md).
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "slipwise/hypotheses/model_average.hpp"
#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/present.hpp"
#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr std::size_t kProbes = 20;     // segments by which surfaces are compared
constexpr std::size_t kProbeEvery = 4;  // segments from one to the next

}  // namespace

Eigen::VectorXd SurfaceTrial::probabilities() const {
  const Eigen::ArrayXd odds = (log_odds.array() - log_odds.maxCoeff()).exp();
  return odds / odds.sum();
}

/// Keeps what was known before a segment, as long as one surface is driven on.
void ModelAverage::note_recent() {
  if (!settings_.surfaces.remember || trial_) {
    return;
  }
  const Learning& now = present(learning_);
  recent_.push_back({now.inputs, now.segment, remember(), state()});
  if (std::ssize(recent_) > settings_.change.longest) {
    recent_.pop_front();
  }
  if (observed_ % kProbeEvery == 0) {
    probes_.push_back({now.inputs, now.segment, {}, {}});
  }
  if (probes_.size() > kProbes) {
    probes_.pop_front();
  }
}

SurfaceMemory ModelAverage::remember() const {
  const std::size_t bases = places_.size();
  std::size_t best = 0;
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(prior_.size());
  for (std::size_t side = 0; side < sides(); ++side) {
    const Eigen::VectorXd part = weights_.segment(static_cast<Eigen::Index>(side * bases), prior_.size());
    if (part.sum() > weights.sum()) {
      best = side;
      weights = part;
    }
  }
  SurfaceMemory memory{.slips = {}, .weights = weights / weights.sum(), .observed = observed_};
  if (trial_) {
    memory.observed = present(trial_).observed[best];
  }
  for (std::size_t i = 0; i < bases; ++i) {
    memory.slips.push_back(filters_[best * bases + i].surface());
  }
  return memory;
}

std::size_t ModelAverage::recent_since(double since) const {
  std::size_t first = recent_.size();
  while (first > 0 && !later(since, recent_[first - 1].segment.start)) {
    --first;
  }
  return first;
}

void ModelAverage::mark_parting(double since) {
  const std::size_t first = recent_since(since);
  parting_ = first < recent_.size() ? recent_[first].memory : remember();
}

std::vector<CausalFilter> ModelAverage::filters_on(const SurfaceMemory& surface, double drift) const {
  const std::size_t bases = places_.size();
  std::vector<CausalFilter> filters(filters_.begin(), filters_.begin() + static_cast<std::ptrdiff_t>(bases));
  for (std::size_t i = 0; i < bases; ++i) {
    filters[i].go_on_with(surface.slips[i], drift);
  }
  return filters;
}

AverageState ModelAverage::state_on(const SurfaceMemory& surface) const {
  AverageState state = state_of(filters_on(surface, 0.0), surface.weights);
  state.weights = surface.weights;
  return state;
}

SurfacePosterior ModelAverage::posterior_of(const AverageState& state) const {
  return {.estimate = state.estimate,
          .prior_std = state.prior_std,
          .noise = filters_.front().noise().shape,
          .noise_scale = state.noise_scale};
}

/// Bases are weighted as on the surfaces that are known.
SurfaceMemory ModelAverage::new_surface(std::span<const SurfaceMemory> known, const SurfaceMemory& present) const {
  SurfaceMemory fresh{.slips = {}, .weights = Eigen::VectorXd::Zero(prior_.size())};
  std::vector<SurfaceMemory> all(known.begin(), known.end());
  if (all.empty()) {
    all.push_back(present);
  }
  for (std::size_t i = 0; i < places_.size(); ++i) {
    std::vector<SurfaceSlip> slips;
    std::ranges::transform(all, std::back_inserter(slips), [&](const SurfaceMemory& each) { return each.slips[i]; });
    fresh.slips.push_back(filters_[i].new_surface(slips));
  }
  for (const SurfaceMemory& each : all) {
    fresh.weights += each.weights / static_cast<double>(all.size());
  }
  return fresh;
}

/// Filters of one candidate as it begins, with their weights and estimates.
ModelAverage::Side ModelAverage::side_of(const SurfaceCandidate& candidate, std::span<const SurfaceMemory> known,
                                         std::size_t first) const {
  if (candidate.kind == SurfaceCandidate::Kind::Present) {
    return {.filters = filters_,
            .weights = weights_,
            .observed = observed_,
            .state = first < recent_.size() ? recent_[first].state : state()};
  }
  SurfaceMemory start = present(parting_);
  double drift = 0.0;
  if (candidate.kind == SurfaceCandidate::Kind::Known) {
    start = known[candidate.place];
    drift = settings_.surfaces.drift;
  } else if (candidate.kind == SurfaceCandidate::Kind::New) {
    start = new_surface(known, present(parting_));
  }
  Side side{.filters = filters_on(start, drift), .weights = start.weights, .observed = start.observed, .state = {}};
  if (candidate.kind == SurfaceCandidate::Kind::Changed) {
    std::ranges::for_each(side.filters, [&](CausalFilter& filter) { filter.forget(settings_.change.forget); });
    side.observed = 0;
  }
  side.state = state_of(side.filters, side.weights);
  return side;
}

/// Bases are weighted by the usual rule.
void ModelAverage::learn_on(Side& side, const Recent& recent) const {
  std::vector<Eigen::Vector3d> innovations;
  std::vector<Eigen::Matrix3d> covariances;
  for (CausalFilter& filter : side.filters) {
    const IekfUpdate update = filter.learn(recent.inputs, recent.segment, speeds_.reference());
    innovations.push_back(update.innovation);
    covariances.push_back(update.innovation_covariance);
  }
  side.weights = updated_weights(side.weights, common_log_scores(side.weights, innovations, covariances), prior_,
                                 settings_.weighting, side.observed);
  ++side.observed;
}

void ModelAverage::open_trial(const std::vector<SurfaceCandidate>& candidates, std::span<const SurfaceMemory> known,
                              const DisturbanceModel& law, double since) {
  if (trial_) {
    settle(0);
  }
  if (undecided_ > 0) {
    resolve();
    undecided_ = 0;
  }
  const std::size_t first = recent_since(since);
  mark_parting(since);
  SurfaceTrial trial{.candidates = candidates, .evidence = {}, .weights = {}, .observed = {}, .log_odds = {}};
  trial.log_odds.resize(std::ssize(candidates));
  trial.segments = static_cast<int>(recent_.size() - first);
  std::vector<CausalFilter> filters;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    Side side = side_of(candidates[i], known, first);
    SurfaceEvidence evidence(model_, posterior_of(side.state), law);
    double score = std::log(candidates[i].prior);
    for (std::size_t k = first; k < recent_.size(); ++k) {
      score += settings_.surfaces.learning_rate * evidence.add(model_, recent_[k].inputs, recent_[k].segment);
      if (candidates[i].kind != SurfaceCandidate::Kind::Present) {
        learn_on(side, recent_[k]);
      }
    }
    trial.log_odds[static_cast<Eigen::Index>(i)] = score;
    trial.evidence.push_back(std::move(evidence));
    trial.weights.push_back(std::move(side.weights));
    trial.observed.push_back(side.observed);
    std::ranges::move(side.filters, std::back_inserter(filters));
  }
  filters_ = std::move(filters);
  trial_ = std::move(trial);
  before_.clear();
  detector_.restart();
  recent_.clear();
  mix_trial();
}

void ModelAverage::weigh_trial(const Eigen::VectorXd& log_factors) {
  present(trial_).log_odds += log_factors;
  mix_trial();
}

void ModelAverage::mix_trial() {
  const SurfaceTrial& trial = present(trial_);
  const Eigen::VectorXd likely = trial.probabilities();
  weights_.resize(likely.size() * prior_.size());
  for (Eigen::Index side = 0; side < likely.size(); ++side) {
    weights_.segment(side * prior_.size(), prior_.size()) =
        likely[side] * trial.weights[static_cast<std::size_t>(side)];
  }
}

/// Bases are weighted by the usual rule on each surface, surfaces by the joint density of all segments so far.
void ModelAverage::reweigh_trial() {
  SurfaceTrial& trial = present(trial_);
  const Learning& now = present(learning_);
  const std::size_t bases = places_.size();
  Eigen::Index heaviest = 0;
  weights_.maxCoeff(&heaviest);
  update_ = now.updates[static_cast<std::size_t>(heaviest)];
  for (std::size_t side = 0; side < trial.candidates.size(); ++side) {
    std::vector<Eigen::Vector3d> innovations;
    std::vector<Eigen::Matrix3d> covariances;
    for (std::size_t i = side * bases; i < (side + 1) * bases; ++i) {
      innovations.push_back(now.updates[i].innovation);
      covariances.push_back(now.updates[i].innovation_covariance);
    }
    trial.weights[side] =
        updated_weights(trial.weights[side], common_log_scores(trial.weights[side], innovations, covariances), prior_,
                        settings_.weighting, trial.observed[side]);
    ++trial.observed[side];
    trial.log_odds[static_cast<Eigen::Index>(side)] +=
        settings_.surfaces.learning_rate * trial.evidence[side].add(model_, now.inputs, now.segment);
  }
  ++trial.segments;
  mix_trial();
}

void ModelAverage::settle(std::size_t candidate) {
  SurfaceTrial trial = std::move(present(trial_));
  trial_.reset();
  const auto bases = static_cast<std::ptrdiff_t>(places_.size());
  const auto first = filters_.begin() + static_cast<std::ptrdiff_t>(candidate) * bases;
  std::vector<CausalFilter> kept(std::make_move_iterator(first), std::make_move_iterator(first + bases));
  filters_ = std::move(kept);
  weights_ = trial.weights[candidate];
  observed_ = trial.observed[candidate];
}

/// Both predict the probes with their parameters, noise and disturbance; what differs is held against what is open. Of
/// many segments, noise averages out; what remains is the mean of the disturbance over all of them, what is not known
/// of both surfaces, and that surfaces drift.
double ModelAverage::apart(const SurfaceMemory& a, const SurfaceMemory& b, const DisturbanceModel& law) const {
  const AverageState of_a = state_on(a);
  const AverageState of_b = state_on(b);
  const auto count = std::ssize(probes_);
  if (count == 0) {
    return 0.0;
  }
  const Eigen::Index slip = model_.slip_size();
  const DisturbedTerms terms = disturbed_terms(model_, of_a.prior_std);
  const double each = settings_.surfaces.alike / static_cast<double>(count);  // segments that are like one probe
  Eigen::MatrixXd by_slip(3 * count, slip);
  Eigen::VectorXd difference(3 * count);
  Eigen::MatrixXd open = Eigen::MatrixXd::Zero(3 * count, 3 * count);
  double seconds = 0.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Recent& probe = probes_[static_cast<std::size_t>(i)];
    const auto at = linearize_segment(model_, of_a.estimate.mean, probe.inputs, probe.segment);
    const auto other = linearize_segment(model_, of_b.estimate.mean, probe.inputs, probe.segment);
    by_slip.middleRows<3>(3 * i) = at.by_parameter.leftCols(slip);
    difference.segment<3>(3 * i) = other.predicted.vector() - at.predicted.vector();
    const Eigen::Vector3d scale = (of_a.noise_scale + of_b.noise_scale) / 2.0;
    open.block<3, 3>(3 * i, 3 * i) =
        segment_noise(at.path, probe.segment.measured, filters_.front().noise().shape, scale) / each;
    seconds += each * (probe.segment.end - probe.segment.start);
  }
  Eigen::MatrixXd common =
      of_a.estimate.covariance.topLeftCorner(slip, slip) + of_b.estimate.covariance.topLeftCorner(slip, slip);
  common.diagonal() += settings_.surfaces.drift * of_a.prior_std.head(slip).cwiseAbs2();
  common.diagonal()(terms.places) += nominal_variances(law, terms, seconds);
  open += by_slip * common * by_slip.transpose();
  return difference.dot(Cholesky(open).solve(difference)) / 2.0;
}

}  // namespace slipwise
