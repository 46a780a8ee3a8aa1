// SPDX-License-Identifier: Apache-2.0
// Names of surfaces, by labels and by what sensors say of the terrain: odds of the surfaces that bore them before.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "slipwise/hypotheses/surface_bank.hpp"
#include "slipwise/linear/present.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

using Kind = SurfaceCandidate::Kind;

SLIPWISE_TUNING(kFarBetter, 4.0);  // likelihood ratio at which a trial begins [-]

}  // namespace

/// A label says nothing new where it is the one that speaks already, or names the surface that is driven on.
void SurfaceBank::cue(const Averages& averages, const DisturbanceModel& law, const std::string& label) {
  const bool open_already = trial_.has_value() && !held_;
  const std::string named = open_already ? label_ : (surfaces_.present() ? surfaces_.present_name() : wanted_);
  const bool same = !label.empty() && label == named;
  if (!settings_.remember || same || (open_already && label.empty())) {
    return;
  }
  if (open_already && trial_->segments() < settings_.soonest) {
    label_ = label;
    weigh_trial(averages, label_factors(trial_->candidates()).log());
    return;
  }
  if (open_already) {  // what was driven so far was on one surface
    settle(averages, law, true);
  }
  keep_present(averages, law);
  label_ = label;
  wanted_ = surfaces_.size() == 0 ? label_ : wanted_;  // nothing competes
  suspect(averages, law);
}

std::string SurfaceBank::name_of(const SurfaceCandidate& candidate) const {
  if (candidate.kind == Kind::Known) {
    return surfaces_[candidate.place].name;
  }
  return candidate.kind == Kind::Present ? surfaces_.present_name() : "";
}

/// How likely the label is on each candidate, by what labels have been worth: it names the surface, or another one. A
/// label that names no surface speaks for those without a name of their own.
Eigen::ArrayXd SurfaceBank::label_factors(const std::vector<SurfaceCandidate>& candidates) const {
  const auto count = std::ssize(candidates);
  if (label_.empty() || count < 2) {
    return Eigen::ArrayXd::Ones(count);
  }
  const bool known = std::ranges::any_of(candidates, [&](const auto& each) { return name_of(each) == label_; });
  Eigen::ArrayXd factors(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const SurfaceCandidate& each = candidates[static_cast<std::size_t>(i)];
    const std::string name = name_of(each);
    const bool named =
        known ? name == label_ : !each.known() || (each.kind == Kind::Known && SurfaceList::numbered(name));
    factors[i] = named ? label_reliability() : (1.0 - label_reliability()) / static_cast<double>(count - 1);
  }
  return factors;
}

void SurfaceBank::weigh_by_label(std::vector<SurfaceCandidate>& candidates) const {
  const Eigen::ArrayXd factors = label_factors(candidates);
  double total = 0.0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    candidates[i].prior *= factors[static_cast<Eigen::Index>(i)];
    total += candidates[i].prior;
  }
  std::ranges::for_each(candidates, [&](SurfaceCandidate& each) { each.prior /= total; });
}

/// Counts whether the label was right, as far as the surface that was taken tells; returns the name of the one that was
/// recalled. One that had a number for a name gets the label for its name.
std::string SurfaceBank::judge_label(const SurfaceCandidate& candidate, const std::string& recalled, bool sure) {
  if (candidate.kind != Kind::Present) {
    wanted_.clear();
  }
  if (label_.empty()) {
    return recalled;
  }
  const std::size_t here =
      candidate.kind == Kind::Present ? surfaces_.present().value_or(surfaces_.size()) : surfaces_.place_of(recalled);
  const bool entry = here < surfaces_.size();
  const bool nameless = entry && SurfaceList::numbered(surfaces_[here].name) && !surfaces_.taken(label_);
  const bool right = entry ? nameless || surfaces_[here].name == label_ : !surfaces_.taken(label_);
  if (sure) {  // else nothing but the label may have decided
    labels_.all += 1.0;
    labels_.right += right ? 1.0 : 0.0;
  }
  if (nameless) {
    surfaces_[here].name = label_;
  } else if (right && !entry) {
    wanted_ = label_;
  }
  return entry && !recalled.empty() ? surfaces_[here].name : recalled;
}

/// Of the present surface, what was said since it was taken counts as one visit more.
ClassCounts SurfaceBank::heard_on_present() const {
  ClassCounts classes = surfaces_.present() ? surfaces_[*surfaces_.present()].classes : ClassCounts{};
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
      surface = {surfaces_.present() ? surfaces_.present_name() : wanted_, heard_on_present()};
    }
    found[static_cast<Eigen::Index>(i)] = likelihood_of(said, surface);
  }
  return found;
}

/// The mean of all that was said is one cue: what it is worth now replaces what it was worth before.
void SurfaceBank::weigh_by_classes(const Averages& averages) {
  const SurfaceTrial& trial = slipwise::present(trial_);
  const Eigen::ArrayXd now = class_likelihoods(trial.candidates(), shares_of(heard_in_trial_)).log();
  const Eigen::Map<Eigen::ArrayXd> before(heard_factors_.data(), std::ssize(heard_factors_));
  const Eigen::VectorXd change = now - before;
  std::ranges::copy(now, heard_factors_.begin());
  weigh_trial(averages, change);
}

void SurfaceBank::hear(const Averages& averages, const DisturbanceModel& law, const TerrainAnswer& answer) {
  check_answer(answer);
  if (!settings_.remember) {
    return;
  }
  const ClassCounts said = even_odds(answer);
  const auto likeliest = std::ranges::max_element(said, {}, [](const auto& each) { return each.second; });
  if (!trial_ || held_) {
    const std::vector<SurfaceCandidate> candidates =
        candidates_of_change(surfaces_.size(), surfaces_.present(), held_, settings_);
    const Eigen::ArrayXd likelihoods = class_likelihoods(candidates, said);
    const bool others = surfaces_.size() > (surfaces_.present() ? 1 : 0);
    if (!others || doubted_for_ == likeliest->first || likelihoods.maxCoeff() < kFarBetter * likelihoods[0]) {
      add_counts(said, heard_);
      return;
    }
    keep_present(averages, law);
    label_.clear();
    doubted_for_ = likeliest->first;
    suspect(averages, law);
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
