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
constexpr std::ptrdiff_t kRecent = 10;  // segments that are learned again on another surface, at most

}  // namespace

/// Keeps what was known before a segment, as long as one surface is driven on.
void ModelAverage::note_recent() {
  if (!settings_.surfaces.remember || trial_) {
    return;
  }
  const Learning& now = present(learning_);
  recent_.push_back({now.inputs, now.segment, remember(), state()});
  if (std::ssize(recent_) > kRecent) {
    recent_.pop_front();
  }
  if (filters_.observed() % kProbeEvery == 0) {
    probes_.push_back({now.inputs, now.segment, {}, {}});
  }
  if (probes_.size() > kProbes) {
    probes_.pop_front();
  }
}

SurfaceMemory ModelAverage::remember() const {
  const std::size_t bases = places_.size();
  std::size_t best = 0;
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(std::ssize(places_));
  for (std::size_t side = 0; side < sides(); ++side) {
    const Eigen::VectorXd part = filters_.weights().segment(static_cast<Eigen::Index>(side * bases), weights.size());
    if (part.sum() > weights.sum()) {
      best = side;
      weights = part;
    }
  }
  SurfaceMemory memory{.slips = {},
                       .weights = weights / weights.sum(),
                       .observed = trial_ ? trial_->sides[best].bases.observed() : filters_.observed()};
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

HypothesisBank<CausalFilter> ModelAverage::filters_on(const SurfaceMemory& surface, double drift) const {
  HypothesisBank<CausalFilter> filters = filters_.chosen(side_places(0));
  for (std::size_t i = 0; i < filters.size(); ++i) {
    filters[i].go_on_with(surface.slips[i], drift);
  }
  filters.begin_with(surface.weights, surface.observed);
  return filters;
}

AverageState ModelAverage::state_on(const SurfaceMemory& surface) const {
  AverageState state = state_of(filters_on(surface, 0.0).keys(), surface.weights);
  state.weights = surface.weights;
  return state;
}

SurfacePosterior ModelAverage::posterior_of(const AverageState& state) const {
  return {.estimate = state.estimate,
          .prior_std = state.prior_std,
          .noise = filters_[0].noise().shape,
          .noise_scale = state.noise_scale};
}

/// Bases are weighted as on the surfaces that are known.
SurfaceMemory ModelAverage::new_surface(std::span<const SurfaceMemory> known, const SurfaceMemory& present) const {
  SurfaceMemory fresh{.slips = {}, .weights = Eigen::VectorXd::Zero(std::ssize(places_))};
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
    return {.filters = filters_, .state = first < recent_.size() ? recent_[first].state : state()};
  }
  SurfaceMemory start = present(parting_);
  double drift = 0.0;
  if (candidate.kind == SurfaceCandidate::Kind::Known) {
    start = known[candidate.place];
    drift = settings_.surfaces.drift;
  } else if (candidate.kind == SurfaceCandidate::Kind::New) {
    start = new_surface(known, present(parting_));
  }
  const bool changed = candidate.kind == SurfaceCandidate::Kind::Changed;
  start.observed = changed ? 0 : start.observed;
  Side side{.filters = filters_on(start, drift), .state = {}};
  if (changed) {
    std::ranges::for_each(side.filters.keys(), &CausalFilter::expect_change);
  }
  side.state = state_of(side.filters.keys(), start.weights);
  return side;
}

/// Bases are weighted by the usual rule.
void ModelAverage::learn_on(Side& side, const Recent& recent) const {
  std::vector<IekfUpdate> updates;
  for (CausalFilter& filter : side.filters.keys()) {
    updates.push_back(filter.learn(recent.inputs, recent.segment, speeds_.reference()));
  }
  side.filters.learn(scores_of(side.filters.weights(), updates), settings_.weighting);
}

void ModelAverage::open_trial(const std::vector<SurfaceCandidate>& candidates, std::span<const SurfaceMemory> known,
                              const DisturbanceModel& law, double since) {
  if (trial_) {
    settle(0);
  }
  const std::size_t first = recent_since(since);
  mark_parting(since);
  SurfaceTrial trial{.candidates = candidates, .segments = static_cast<int>(recent_.size() - first)};
  HypothesisBank<CausalFilter> filters;
  for (const SurfaceCandidate& candidate : candidates) {
    Side side = side_of(candidate, known, first);
    SurfaceEvidence evidence(model_, posterior_of(side.state), law);
    double score = std::log(candidate.prior);
    for (std::size_t k = first; k < recent_.size(); ++k) {
      score += settings_.surfaces.learning_rate * evidence.add(model_, recent_[k].inputs, recent_[k].segment);
      if (candidate.kind != SurfaceCandidate::Kind::Present) {
        learn_on(side, recent_[k]);
      }
    }
    const HypothesisWeights& bases = side.filters;
    trial.sides.add({.evidence = std::move(evidence), .bases = bases}, candidate.prior, score);
    for (std::size_t i = 0; i < side.filters.size(); ++i) {
      filters.add(std::move(side.filters[i]), bases.prior()[static_cast<Eigen::Index>(i)]);
    }
  }
  trial.sides.weigh(Eigen::VectorXd::Zero(std::ssize(candidates)));
  filters_ = std::move(filters);
  trial_ = std::move(trial);
  recent_.clear();
  mix_trial();
}

void ModelAverage::weigh_trial(const Eigen::VectorXd& log_factors) {
  present(trial_).sides.weigh(log_factors);
  mix_trial();
}

void ModelAverage::mix_trial() {
  const SurfaceTrial& trial = present(trial_);
  const Eigen::VectorXd& likely = trial.probabilities();
  Eigen::MatrixXd weights(std::ssize(places_), likely.size());
  for (Eigen::Index side = 0; side < likely.size(); ++side) {
    weights.col(side) = likely[side] * trial.sides[static_cast<std::size_t>(side)].bases.weights();
  }
  filters_.begin_with(weights.reshaped(), filters_.observed());
}

/// Bases are weighted by the usual rule on each surface, surfaces by the joint density of all segments so far.
void ModelAverage::reweigh_trial() {
  SurfaceTrial& trial = present(trial_);
  const Learning& now = present(learning_);
  const std::size_t bases = places_.size();
  update_ = now.updates[filters_.heaviest()];
  change_ = {};
  Eigen::VectorXd scores(trial.probabilities().size());
  for (std::size_t i = 0; i < trial.sides.size(); ++i) {
    SurfaceSide& side = trial.sides[i];
    const auto updates = std::span(now.updates).subspan(i * bases, bases);
    side.bases.learn(scores_of(side.bases.weights(), updates), settings_.weighting);
    scores[static_cast<Eigen::Index>(i)] =
        settings_.surfaces.learning_rate * side.evidence.add(model_, now.inputs, now.segment);
  }
  trial.sides.weigh(scores);
  ++trial.segments;
  mix_trial();
}

void ModelAverage::settle(std::size_t candidate) {
  SurfaceTrial trial = std::move(present(trial_));
  trial_.reset();
  filters_ = filters_.chosen(side_places(candidate));
  const HypothesisWeights& taken = trial.sides[candidate].bases;
  filters_.begin_with(taken.weights(), taken.observed());
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
  Eigen::Index rows = 0;
  for (const Recent& probe : probes_) {
    rows += rows_of(probe.segment.measured).size();
  }
  Eigen::MatrixXd by_slip(rows, slip);
  Eigen::VectorXd difference(rows);
  Eigen::MatrixXd open = Eigen::MatrixXd::Zero(rows, rows);
  double seconds = 0.0;
  Eigen::Index row = 0;
  for (const Recent& probe : probes_) {
    const auto at = linearize_segment(model_, of_a.estimate.mean, probe.inputs, probe.segment);
    const auto other = linearize_segment(model_, of_b.estimate.mean, probe.inputs, probe.segment);
    const Eigen::Index measured = at.predicted.size();
    by_slip.middleRows(row, measured) = at.by_parameter.leftCols(slip);
    difference.segment(row, measured) = other.predicted - at.predicted;
    const Eigen::Vector3d scale = (of_a.noise_scale + of_b.noise_scale) / 2.0;
    open.block(row, row, measured, measured) =
        segment_noise(at.path, rows_of(probe.segment.measured), filters_[0].noise().shape, scale) / each;
    row += measured;
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
