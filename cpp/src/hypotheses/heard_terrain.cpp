// SPDX-License-Identifier: Apache-2.0
// What sensors say of the terrain, as odds of the surfaces that they said it on before.
#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "slipwise/hypotheses/surface_bank.hpp"
#include "slipwise/linear/present.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

using Kind = SurfaceCandidate::Kind;

SLIPWISE_TUNING(kFarBetter, 4.0);  // likelihood ratio at which a trial begins [-]

}  // namespace

/// Of the present surface, what was said since it was taken counts as one visit more.
ClassCounts SurfaceBank::heard_on_present() const {
  ClassCounts classes = present_ ? surfaces_[*present_].classes : ClassCounts{};
  add_visit(heard_, classes);
  return classes;
}

/// A surface that changed is as good as new.
Eigen::ArrayXd SurfaceBank::class_likelihoods(const std::vector<SurfaceCandidate>& candidates,
                                              const ClassCounts& said) const {
  Eigen::ArrayXd found(std::ssize(candidates));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    NamedClasses surface;
    if (candidates[i].kind == Kind::Known) {
      const Surface& known = surfaces_[candidates[i].place];
      surface = {known.name, known.classes};
    } else if (candidates[i].kind == Kind::Present) {
      surface = {present_ ? surfaces_[*present_].name : wanted_, heard_on_present()};
    }
    found[static_cast<Eigen::Index>(i)] = likelihood_of(said, surface);
  }
  return found;
}

/// The mean of all that was said is one cue: what it is worth now replaces what it was worth before.
void SurfaceBank::weigh_by_classes(const Averages& averages) {
  const auto& trial = slipwise::present(averages[leader_]->trial());
  const Eigen::ArrayXd now = class_likelihoods(trial.candidates, shares_of(heard_in_trial_)).log();
  const Eigen::Map<Eigen::ArrayXd> before(heard_factors_.data(), std::ssize(heard_factors_));
  const Eigen::VectorXd change = now - before;
  std::ranges::copy(now, heard_factors_.begin());
  for (ModelAverage* average : averages) {
    if (average != nullptr && average->trial()) {
      average->weigh_trial(change);
    }
  }
}

void SurfaceBank::hear(const Averages& averages, const DisturbanceModel& law, const TerrainAnswer& answer) {
  check_answer(answer);
  if (!settings_.remember) {
    return;
  }
  const ClassCounts said = even_odds(answer);
  const auto likeliest = std::ranges::max_element(said, {}, [](const auto& each) { return each.second; });
  if (!averages[leader_]->trial()) {
    const std::vector<SurfaceCandidate> candidates = candidates_of_change();
    const Eigen::ArrayXd likelihoods = class_likelihoods(candidates, said);
    const bool others = surfaces_.size() > (present_ ? 1 : 0);
    if (!others || doubted_for_ == likeliest->first || likelihoods.maxCoeff() < kFarBetter * likelihoods[0]) {
      add_counts(said, heard_);
      return;
    }
    keep_present(averages, law);
    label_.clear();
    doubted_for_ = likeliest->first;
    open(averages, law, candidates_of_change(), std::numeric_limits<double>::infinity());
  }
  add_counts(said, heard_in_trial_);
  weigh_by_classes(averages);
}

/// What was said in the trial was said of the surface that is taken.
void SurfaceBank::hear_on(Kind taken) {
  if (taken != Kind::Present) {
    heard_.clear();
    doubted_for_.clear();
  }
  add_counts(heard_in_trial_, heard_);
  heard_in_trial_.clear();
}

}  // namespace slipwise
