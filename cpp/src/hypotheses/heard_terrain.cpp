// SPDX-License-Identifier: Apache-2.0
// Odds of surfaces by the classes that were said on them before.
#include "slipwise/hypotheses/heard_terrain.hpp"

#include <algorithm>

#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

using Kind = SurfaceCandidate::Kind;

SLIPWISE_TUNING(kFarBetter, 4.0);  // likelihood ratio at which a trial begins [-]

}  // namespace

/// A surface that changed is as good as new. Of the present one, what was said since it was taken counts as one visit.
Eigen::ArrayXd HeardTerrain::likelihoods(const ClassCounts& said, const std::vector<SurfaceCandidate>& candidates,
                                         const SurfaceList& surfaces, const std::string& here) const {
  Eigen::ArrayXd found(std::ssize(candidates));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    NamedClasses surface;
    if (candidates[i].kind == Kind::Known) {
      const Surface& known = surfaces[candidates[i].place];
      surface = {known.name, known.classes};
    } else if (candidates[i].kind == Kind::Present) {
      surface = {here, surfaces.present() ? surfaces[*surfaces.present()].classes : ClassCounts{}};
      add_visit(heard_, surface.classes);
    }
    found[static_cast<Eigen::Index>(i)] = likelihood_of(said, surface);
  }
  return found;
}

bool HeardTerrain::hear(const ClassCounts& said, const std::vector<SurfaceCandidate>& candidates,
                        const SurfaceList& surfaces, const std::string& here) {
  const auto likeliest = std::ranges::max_element(said, {}, &ClassCounts::value_type::second);
  const Eigen::ArrayXd found = likelihoods(said, candidates, surfaces, here);
  const bool others = std::ranges::any_of(candidates, [](const auto& each) { return each.kind == Kind::Known; });
  if (!others || doubted_for_ == likeliest->first || found.maxCoeff() < kFarBetter * found[0]) {
    add_counts(said, heard_);
    return false;
  }
  doubted_for_ = likeliest->first;
  return true;
}

/// The mean of all that was said is one cue: what it is worth now replaces what it was worth before.
Eigen::VectorXd HeardTerrain::hear_in_trial(const ClassCounts& said, const std::vector<SurfaceCandidate>& candidates,
                                            const SurfaceList& surfaces, const std::string& here) {
  add_counts(said, in_trial_);
  const Eigen::ArrayXd now = likelihoods(shares_of(in_trial_), candidates, surfaces, here).log();
  const Eigen::Map<Eigen::ArrayXd> before(factors_.data(), std::ssize(factors_));
  const Eigen::VectorXd change = now - before;
  std::ranges::copy(now, factors_.begin());
  return change;
}

void HeardTerrain::begin() {
  heard_.clear();
  forget_doubt();
}

void HeardTerrain::begin_trial(std::size_t candidates) {
  in_trial_.clear();
  factors_.assign(candidates, 0.0);
}

void HeardTerrain::end_trial(bool another) {
  if (another) {
    begin();
  }
  add_counts(in_trial_, heard_);
  in_trial_.clear();
}

void HeardTerrain::leave(Surface& surface) {
  add_visit(heard_, surface.classes);
  heard_.clear();
}

}  // namespace slipwise
