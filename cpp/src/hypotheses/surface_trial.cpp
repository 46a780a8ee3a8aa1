// SPDX-License-Identifier: Apache-2.0
// The evidence of segments for each surface.
#include "slipwise/hypotheses/surface_trial.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace slipwise {

using Kind = SurfaceCandidate::Kind;

std::vector<SurfaceCandidate> candidates_of_start(std::size_t surfaces, const SurfaceSettings& settings) {
  std::vector<SurfaceCandidate> candidates;
  const auto count = static_cast<double>(surfaces);
  const double unknown = settings.unknown / (count + 1.0);
  for (std::size_t i = 0; i < surfaces; ++i) {
    candidates.push_back({.kind = Kind::Known, .place = i, .prior = (1.0 - settings.unknown) / count});
    candidates.push_back({.kind = Kind::Alike, .place = i, .prior = unknown});
  }
  candidates.push_back({.kind = Kind::New, .prior = unknown});
  return candidates;
}

std::vector<SurfaceCandidate> candidates_of_change(std::size_t surfaces, std::optional<std::size_t> present,
                                                   bool doubted, const SurfaceSettings& settings) {
  const std::size_t place = doubted && present ? *present : SurfaceCandidate::kNone;
  std::vector<SurfaceCandidate> candidates{{.kind = Kind::Present, .place = place, .prior = 1.0 - settings.changed},
                                           {.kind = Kind::Changed, .place = place}};
  for (std::size_t i = 0; i < surfaces; ++i) {
    if (present != i) {
      candidates.push_back({.kind = Kind::Known, .place = i});
      candidates.push_back({.kind = Kind::Alike, .place = i});
    }
  }
  candidates.push_back({.kind = Kind::New});
  for (std::size_t i = 1; i < candidates.size(); ++i) {
    candidates[i].prior = settings.changed / static_cast<double>(candidates.size() - 1);
  }
  return candidates;
}

SurfaceTrial::SurfaceTrial(std::vector<SurfaceCandidate> candidates, std::span<const SurfaceMemory> known,
                           const RememberingAverage& average, const DisturbanceModel& law, double since)
    : candidates_(std::move(candidates)) {
  const auto& recent = average.recent();
  const std::size_t first = average.recent_since(since);
  const double rate = average.settings().learning_rate;
  segments_ = static_cast<int>(recent.size() - first);
  last_ = recent.empty() ? 0.0 : recent.back().segment.end;
  for (const SurfaceCandidate& candidate : candidates_) {
    SurfaceEvidence evidence(average.average().model(), average.posterior_on(candidate, known, since), law);
    double score = std::log(candidate.prior);
    for (std::size_t k = first; k < recent.size(); ++k) {
      score += rate * evidence.add(average.average().model(), recent[k].inputs, recent[k].segment);
    }
    evidence_.add(std::move(evidence), candidate.prior, score);
  }
  evidence_.weigh(Eigen::VectorXd::Zero(std::ssize(candidates_)));
}

void SurfaceTrial::follow(const RememberingAverage& average) {
  if (average.recent().empty() || average.recent().back().segment.end == last_) {
    return;
  }
  const RememberingAverage::Recent& now = average.recent().back();
  const double rate = average.settings().learning_rate;
  last_ = now.segment.end;
  Eigen::VectorXd scores(probabilities().size());
  for (std::size_t i = 0; i < evidence_.size(); ++i) {
    scores[static_cast<Eigen::Index>(i)] = rate * evidence_[i].add(average.average().model(), now.inputs, now.segment);
  }
  evidence_.weigh(scores);
  ++segments_;
}

SurfaceDecision SurfaceTrial::decide(const Eigen::ArrayXd& by_label, const SurfaceSettings& settings) const {
  SurfaceDecision found;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const double probability = probabilities()[static_cast<Eigen::Index>(i)];
    found.another += candidates_[i].known() ? 0.0 : probability;
    if (candidates_[i].known() && probability > found.probability) {
      found.known = i;
      found.probability = probability;
    }
  }
  const bool another = found.another >= 1.0 - settings.false_alarm;
  const std::size_t likeliest = another ? candidates_.size() - 1 : found.known;  // the last is a new one
  const bool overruled = by_label[static_cast<Eigen::Index>(likeliest)] < by_label.maxCoeff();
  found.sure = (another || found.probability >= 1.0 - settings.doubt) &&
               segments_ >= (overruled ? settings.fewest : settings.soonest);
  return found;
}

void SurfaceTrial::hold(std::size_t candidate) {
  const SurfaceCandidate held = candidates_[candidate];
  const auto alike = std::ranges::find_if(
      candidates_, [&](const SurfaceCandidate& each) { return each.kind == Kind::Alike && each.place == held.place; });
  const std::array places{candidate, static_cast<std::size_t>(alike - candidates_.begin())};
  candidates_ = {{.kind = Kind::Present}, {.kind = Kind::Changed}};
  evidence_ = evidence_.chosen(places);
  evidence_.weigh(Eigen::VectorXd::Zero(2));
}

}  // namespace slipwise
