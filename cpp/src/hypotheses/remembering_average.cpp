// SPDX-License-Identifier: Apache-2.0
// What an average predicts on surfaces that it remembers (derivations/surfaces.md).
#include "slipwise/hypotheses/remembering_average.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "slipwise/filter/branch_bank.hpp"
#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

constexpr std::size_t kProbes = 20;     // segments by which surfaces are compared
constexpr std::size_t kProbeEvery = 4;  // segments from one to the next
constexpr std::ptrdiff_t kRecent = 10;  // segments that may have been on another surface, at most

/// Segments at steady speeds, by which surfaces are compared before any was driven.
std::vector<std::pair<InputHistory, Segment>> steady_segments(const ReferenceSpeeds& speeds, double seconds) {
  std::vector<std::pair<InputHistory, Segment>> all;
  for (const double v : {0.5, 1.0}) {
    for (const double omega : {-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0}) {
      const BodyTwist twist{.v = v * speeds.v, .vy = 0.0, .omega = omega * speeds.omega};
      const Pose2 end = exp(Eigen::Vector3d(twist.v * seconds, 0.0, twist.omega * seconds));
      all.emplace_back(InputHistory({-1.0}, {twist}),
                       Segment{.start = 0.0, .end = seconds, .measured = measured_pose(end)});
    }
  }
  return all;
}

}  // namespace

void RememberingAverage::start(const InputHistory& inputs, const Segment& segment) {
  while (advance()) {
  }
  average_.start(inputs, segment);
  note(inputs, segment);
}

bool RememberingAverage::advance() {
  const Segment* learning = average_.learning();
  if (learning == nullptr) {
    return false;
  }
  const double start = learning->start;
  const bool more = average_.advance();
  if (const SlipChange& change = average_.change(); !more && change.alarm) {
    const auto first = std::ssize(recent_) - std::min<std::ptrdiff_t>(change.segments, std::ssize(recent_));
    changed_since_ = recent_.empty() ? start : recent_[static_cast<std::size_t>(first)].segment.start;
  }
  return more;
}

/// Keeps what was known before a segment, as long as one surface is driven on.
void RememberingAverage::note(const InputHistory& inputs, const Segment& segment) {
  if (!settings().remember) {
    return;
  }
  SurfaceMemory now = average_.remember();
  if (now.observed % kProbeEvery == 0) {
    probes_.push_back({inputs, segment, {}, {}});
  }
  if (probes_.size() > kProbes) {
    probes_.pop_front();
  }
  recent_.push_back({inputs, segment, std::move(now), average_.state()});
  if (std::ssize(recent_) > kRecent) {
    recent_.pop_front();
  }
}

std::size_t RememberingAverage::recent_since(double since) const {
  std::size_t first = recent_.size();
  while (first > 0 && !later(since, recent_[first - 1].segment.start)) {
    --first;
  }
  return first;
}

void RememberingAverage::mark_parting(double since) {
  const std::size_t first = recent_since(since);
  parting_ = first < recent_.size() ? recent_[first].memory : average_.remember();
}

SurfacePosterior RememberingAverage::posterior_of(const AverageState& state) const {
  return {.estimate = state.estimate,
          .prior_std = state.prior_std,
          .noise = average_.noise(),
          .noise_scale = state.noise_scale};
}

SurfacePosterior RememberingAverage::posterior_on(const SurfaceCandidate& candidate,
                                                  std::span<const SurfaceMemory> known, double since) const {
  using Kind = SurfaceCandidate::Kind;
  const std::size_t first = recent_since(since);
  const bool before = first < recent_.size();
  if (candidate.kind == Kind::New) {
    std::vector<SurfaceMemory> all(known.begin(), known.end());
    if (all.empty()) {
      all.push_back(before ? recent_[first].memory : average_.remember());
    }
    return posterior_of(average_.state_on(average_.new_surface(all)));
  }
  SurfacePosterior posterior = posterior_of(candidate.place != SurfaceCandidate::kNone
                                                ? average_.state_on(known[candidate.place], settings().drift)
                                            : before ? recent_[first].state
                                                     : average_.state());
  if (candidate.kind == Kind::Changed || candidate.kind == Kind::Alike) {
    const Eigen::VectorXd unit = slip_prior_std(average_.model().basis(), average_.reference_speeds(), 1.0);
    posterior.jumped = BranchBank(average_.model(), {.follow = true}).jumps(posterior.estimate, unit);
    if (posterior.jumped.empty()) {  // slip of no kind that jumps
      return posterior_on({.kind = Kind::New}, known, since);
    }
  }
  return posterior;
}

/// Both predict the probes with their parameters, noise and disturbance; what differs is held against what is open. Of
/// many segments, noise averages out; what remains is the mean of the disturbance over all of them, what is not known
/// of both surfaces, and that surfaces drift.
double RememberingAverage::apart(const SurfaceMemory& a, const SurfaceMemory& b, const DisturbanceModel& law) const {
  const AverageState of_a = average_.state_on(a);
  const AverageState of_b = average_.state_on(b);
  const auto count = std::ssize(probes_);
  if (count == 0) {
    return 0.0;
  }
  const MotionModel& model = average_.model();
  const Eigen::Index slip = model.slip_size();
  const DisturbedTerms terms = disturbed_terms(model, of_a.prior_std);
  const double each = settings().alike / static_cast<double>(count);  // segments that are like one probe
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
    const auto at = linearize_segment(model, of_a.estimate.mean, probe.inputs, probe.segment);
    const auto other = linearize_segment(model, of_b.estimate.mean, probe.inputs, probe.segment);
    const Eigen::Index measured = at.predicted.size();
    by_slip.middleRows(row, measured) = at.by_parameter.leftCols(slip);
    difference.segment(row, measured) = other.predicted - at.predicted;
    const Eigen::Vector3d scale = (of_a.noise_scale + of_b.noise_scale) / 2.0;
    open.block(row, row, measured, measured) =
        segment_noise(at.path, rows_of(probe.segment.measured), average_.noise(), scale) / each;
    row += measured;
    seconds += each * (probe.segment.end - probe.segment.start);
  }
  Eigen::MatrixXd common =
      of_a.estimate.covariance.topLeftCorner(slip, slip) + of_b.estimate.covariance.topLeftCorner(slip, slip);
  common.diagonal() += settings().drift * of_a.prior_std.head(slip).cwiseAbs2();
  common.diagonal()(terms.places) += nominal_variances(law, terms, seconds);
  open += by_slip * common * by_slip.transpose();
  return difference.dot(Cholesky(open).solve(difference)) / 2.0;
}

void RememberingAverage::begin_on(const SurfaceMemory& surface, double seconds, double segment_length) {
  average_.begin_on(surface, seconds);
  for (auto& [inputs, segment] : steady_segments(surface.slips.back().speeds, segment_length)) {
    probes_.push_back({inputs, segment, {}, {}});
  }
}

}  // namespace slipwise
