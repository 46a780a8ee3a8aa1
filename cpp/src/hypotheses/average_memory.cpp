// SPDX-License-Identifier: Apache-2.0
// What a model average remembers of surfaces, and what it predicts on them (derivations/surfaces.md).
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
constexpr std::ptrdiff_t kRecent = 10;  // segments that may have been on another surface, at most

}  // namespace

/// Keeps what was known before a segment, as long as one surface is driven on.
void ModelAverage::note_recent() {
  if (!settings_.surfaces.remember) {
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
  SurfaceMemory memory{.slips = {}, .weights = weights / weights.sum(), .observed = filters_.observed()};
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

AverageState ModelAverage::state_on(const SurfaceMemory& surface, double drift) const {
  AverageState state = state_of(filters_on(surface, drift).keys(), surface.weights);
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

SurfacePosterior ModelAverage::posterior_on(const SurfaceCandidate& candidate, std::span<const SurfaceMemory> known,
                                            double since) const {
  using Kind = SurfaceCandidate::Kind;
  const std::size_t first = recent_since(since);
  const bool before = first < recent_.size();
  if (candidate.kind == Kind::New) {
    return posterior_of(state_on(new_surface(known, before ? recent_[first].memory : remember())));
  }
  SurfacePosterior posterior = posterior_of(candidate.place != SurfaceCandidate::kNone
                                                ? state_on(known[candidate.place], settings_.surfaces.drift)
                                            : before ? recent_[first].state
                                                     : state());
  if (candidate.kind == Kind::Changed || candidate.kind == Kind::Alike) {
    const Eigen::VectorXd unit = slip_prior_std(model_.basis(), speeds_.reference(), 1.0);
    posterior.jumped = BranchBank(model_, {.follow = true}).jumps(posterior.estimate, unit);
    if (posterior.jumped.empty()) {  // slip of no kind that jumps
      return posterior_on({.kind = Kind::New}, known, since);
    }
  }
  return posterior;
}

void ModelAverage::recall(std::span<const RecalledSurface> known) {
  for (std::size_t i = 0; i < filters_.size(); ++i) {
    std::vector<RecalledSlip> slips;
    for (const RecalledSurface& each : known) {
      slips.push_back({.slip = each.memory.slips[i % places_.size()], .probability = each.probability});
    }
    filters_[i].recall(slips, settings_.surfaces.drift);
  }
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
