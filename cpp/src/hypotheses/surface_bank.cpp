// SPDX-License-Identifier: Apache-2.0
// Which surfaces compete, which one is taken, and how the bank is kept tidy.
#include "slipwise/hypotheses/surface_bank.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "slipwise/linear/present.hpp"

namespace slipwise {
namespace {

using Kind = SurfaceCandidate::Kind;

constexpr double kNow = std::numeric_limits<double>::infinity();  // no segment speaks yet

SurfaceEvent::Kind event_of(Kind taken) {
  const auto another = taken == Kind::Known ? SurfaceEvent::Kind::Recalled : SurfaceEvent::Kind::Opened;
  return taken == Kind::Present ? SurfaceEvent::Kind::Kept : another;
}

void mark_parting(const LearnedSlip& learned, double since) {
  learned.for_each([&](std::size_t /*i*/, RememberingAverage& average) { average.mark_parting(since); });
}

/// Slip may be that of the candidates that are known. The present one is what goes on.
void recall(const LearnedSlip& learned, const SurfaceTrial& trial, const SurfaceList& surfaces) {
  learned.for_each([&](std::size_t i, RememberingAverage& average) {
    std::vector<RecalledSurface> known;
    for (std::size_t k = 0; k < trial.candidates().size(); ++k) {
      const SurfaceCandidate& each = trial.candidates()[k];
      if (each.kind == Kind::Known && each.place != surfaces.present() && surfaces[each.place].memories[i]) {
        known.push_back({.memory = *surfaces[each.place].memories[i],
                         .probability = trial.probabilities()[static_cast<Eigen::Index>(k)]});
      }
    }
    average.average().recall(known);
  });
}

/// What is said before any segment speaks counts for predictions too.
void weigh(SurfaceTrial& trial, const Eigen::VectorXd& log_factors, const LearnedSlip& learned,
           const SurfaceList& surfaces) {
  trial.weigh(log_factors);
  if (trial.segments() == 0) {
    recall(learned, trial, surfaces);
  }
}

}  // namespace

void SurfaceBank::see(const InputHistory& inputs, const Segment& segment) {
  if (!settings_.remember) {
    return;
  }
  visit_.see(inputs, segment, trial_ && !held_);
}

/// As it is now; a surface that was hardly driven is not kept.
void SurfaceBank::keep_present(const LearnedSlip& learned) {
  if (!settings_.remember) {
    return;
  }
  mark_parting(learned, kNow);
  visit_.stay();
  leave_present(learned);
}

/// What was known of the present surface at parting is remembered.
void SurfaceBank::leave_present(const LearnedSlip& learned) {
  const int fewest = labels_.wanted().empty() ? settings_.fewest : settings_.soonest;  // a label says that there is one
  if (!surfaces_.present() && std::cmp_less(visit_.segments(), fewest)) {
    return;
  }
  Surface& surface = surfaces_.present() ? surfaces_[*surfaces_.present()] : surfaces_.enter(labels_.take_wanted());
  visit_.leave(surface);
  heard_.leave(surface);
  learned.for_each([&](std::size_t i, RememberingAverage& average) {
    const auto& parting = average.parting();
    surface.memories[i] = parting ? *parting : average.average().remember();
  });
  merge_confounded(learned, slipwise::present(surfaces_.present()));
}

void SurfaceBank::merge_confounded(const LearnedSlip& learned, std::size_t place) {
  if (!settings_.merge) {
    return;
  }
  const RememberingAverage& leader = *learned.averages[leader_];
  const double told_apart = -std::log(settings_.false_alarm);
  const auto known = [&](const Surface& each) {
    return std::cmp_greater_equal(each.segments, settings_.fewest) && each.memories[leader_];
  };
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const Surface& own = surfaces_[place];
    const Surface& other = surfaces_[i];
    // While driving, a label says that they are two; names in two files were never compared.
    const bool named_apart =
        surfaces_.present() && !SurfaceList::numbered(own.name) && !SurfaceList::numbered(other.name);
    if (i != place && !named_apart && known(own) && known(other) &&
        leader.apart(slipwise::present(own.memories[leader_]), slipwise::present(other.memories[leader_]),
                     learned.law) <= told_apart) {
      surfaces_.merge(std::min(i, place), std::max(i, place));
      return;
    }
  }
}

std::vector<SurfaceProbability> SurfaceBank::probabilities() const {
  return settings_.remember ? surface_probabilities(surfaces_, trial_) : std::vector<SurfaceProbability>{};
}

void SurfaceBank::know(std::vector<Surface> surfaces, const LabelCounts& labels) {
  surfaces_.know(std::move(surfaces));
  labels_.know(labels);
}

std::vector<std::string> SurfaceBank::add(const LearnedSlip& learned, std::vector<Surface> others) {
  leader_ = trial_ ? leader_ : learned.leader;
  std::vector<std::string> names;
  for (Surface& other : others) {
    names.push_back(surfaces_.add(std::move(other)));
    merge_confounded(learned, surfaces_.size() - 1);
  }
  surfaces_.drop_least_used(settings_.most);
  return names;
}

void SurfaceBank::open(const LearnedSlip& learned, std::vector<SurfaceCandidate> candidates, double since) {
  labels_.weigh(candidates, surfaces_);
  heard_.begin_trial(candidates.size());
  mark_parting(learned, since);
  const RememberingAverage& leader = *learned.averages[leader_];
  std::vector<SurfaceMemory> known;
  for (const Surface& surface : surfaces_.all()) {  // an average that began later has not learned the older ones
    const auto& memory = surface.memories[leader_];
    known.push_back(memory ? *memory : leader.average().remember());
  }
  trial_.emplace(std::move(candidates), known, leader, learned.law, since);
}

void SurfaceBank::start_drive(const LearnedSlip& learned, const DriveStart& start) {
  if (!settings_.remember) {
    return;
  }
  let_go();
  if (trial_) {
    settle(learned, true);
    let_go();
  }
  keep_present(learned);
  visit_.start_drive(start.date);
  labels_.start_drive(start.label, surfaces_);
  heard_.begin();
  if (surfaces_.size() > 0) {
    open(learned, candidates_of_start(surfaces_.size(), settings_), kNow);
    recall(learned, slipwise::present(trial_), surfaces_);
    surfaces_.leave();
  }
}

/// Something says that the surface may be another from now on.
void SurfaceBank::suspect(const LearnedSlip& learned) {
  const bool doubted = let_go();
  if (surfaces_.size() > 0) {  // what it parts from is what was known before the suspicion
    open(learned, candidates_of_change(surfaces_.size(), surfaces_.present(), doubted, settings_), kNow);
  }
  learned.for_each([](std::size_t /*i*/, RememberingAverage& average) { average.average().take(ChangeExpected{}); });
  if (trial_) {
    recall(learned, *trial_, surfaces_);
  }
}

/// A label says nothing new where it is the one that speaks already, or names the surface that is driven on.
void SurfaceBank::cue(const LearnedSlip& learned, const std::string& label) {
  const bool open_already = trial_.has_value() && !held_;
  const std::string named = open_already ? labels_.label() : labels_.name_here(surfaces_);
  const bool same = !label.empty() && label == named;
  if (!settings_.remember || same || (open_already && label.empty())) {
    return;
  }
  if (open_already && trial_->segments() < settings_.soonest) {
    labels_.say(label);
    weigh(*trial_, labels_.factors(trial_->candidates(), surfaces_).log(), learned, surfaces_);
    return;
  }
  if (open_already) {  // what was driven so far was on one surface
    settle(learned, true);
  }
  keep_present(learned);
  labels_.change(label, surfaces_);
  suspect(learned);
}

void SurfaceBank::hear(const LearnedSlip& learned, const TerrainAnswer& answer) {
  check_answer(answer);
  if (!settings_.remember) {
    return;
  }
  const ClassCounts said = even_odds(answer);
  if (!trial_ || held_) {
    const auto candidates = candidates_of_change(surfaces_.size(), surfaces_.present(), held_, settings_);
    if (!heard_.hear(said, candidates, surfaces_, labels_.name_here(surfaces_))) {
      return;
    }
    keep_present(learned);
    labels_.say("");
    suspect(learned);
  }
  SurfaceTrial& trial = slipwise::present(trial_);
  weigh(trial, heard_.hear_in_trial(said, trial.candidates(), surfaces_, labels_.name_here(surfaces_)), learned,
        surfaces_);
}

void SurfaceBank::consider(const LearnedSlip& learned) {
  if (!settings_.remember) {
    return;
  }
  const auto changed_since = learned.averages[learned.leader]->take_change();
  if (trial_) {
    trial_->follow(*learned.averages[leader_]);
    if (!held_) {
      settle(learned, false);
      return;
    }
    if (!changed_since) {
      doubt();
      return;
    }
  }
  const bool doubted = let_go();
  leader_ = learned.leader;
  if (!changed_since) {
    return;
  }
  if (surfaces_.size() > (surfaces_.present() ? 1 : 0)) {
    labels_.say("");
    open(learned, candidates_of_change(surfaces_.size(), surfaces_.present(), doubted, settings_), *changed_since);
    return;
  }
  mark_parting(learned, *changed_since);
  leave_present(learned);
  heard_.forget_doubt();
  surfaces_.leave_for_new(settings_.most);
}

/// A surface that was recalled turns out to be another, which is like it but for a jump.
void SurfaceBank::doubt() {
  const SurfaceTrial& trial = slipwise::present(trial_);
  const double another = trial.probabilities()[1];
  const int segments = trial.segments();
  if (another >= 1.0 - settings_.false_alarm) {
    --surfaces_[slipwise::present(surfaces_.present())].visits;
    let_go();
    labels_.name_new(surfaces_);
    heard_.forget_doubt();
    surfaces_.take({.kind = SurfaceEvent::Kind::Opened, .name = "", .probability = another, .segments = segments},
                   settings_.most);
  } else if (segments >= settings_.trial) {
    let_go();
  }
}

/// What was recalled is no longer doubted. Whether it was.
bool SurfaceBank::let_go() {
  if (held_) {
    trial_.reset();
  }
  return std::exchange(held_, false);
}

/// Takes a candidate where it is certain enough, or time is over, or at once. A known surface is doubted until time is
/// over.
void SurfaceBank::settle(const LearnedSlip& learned, bool at_once) {
  SurfaceTrial& trial = slipwise::present(trial_);
  const auto& candidates = trial.candidates();
  const bool at_start = candidates.front().kind != Kind::Present;
  const SurfaceDecision decision = trial.decide(labels_.factors(candidates, surfaces_), settings_);
  if (!at_once && !decision.sure && trial.segments() < settings_.trial) {
    return;
  }
  const bool another = decision.another > decision.probability;
  SurfaceCandidate taken = candidates[decision.known];
  double probability = decision.probability;
  const bool named = taken.kind == Kind::Known && surfaces_[taken.place].name == labels_.label();
  const bool labelled = at_once && !labels_.label().empty() && (another ? !surfaces_.taken(labels_.label()) : named);
  const bool suspected = !decision.sure && !at_start && !labelled && trial.probabilities()[0] >= settings_.doubt;
  const bool apart = !decision.sure && at_start && !named;  // is kept apart until it is known better
  if (!suspected && (another || apart)) {
    taken = {.kind = Kind::New};
    probability = decision.another;
  } else if (suspected) {  // without being confirmed
    taken = candidates.front();
    probability = trial.probabilities()[0];
  }
  const int segments = trial.segments();
  const std::string recalled = taken.kind == Kind::Known ? surfaces_[taken.place].name : "";
  if (taken.kind == Kind::Known) {
    trial.hold(decision.known);
    held_ = true;
  } else {
    trial_.reset();
  }
  if (taken.kind != Kind::Present && !at_start) {
    leave_present(learned);
  }
  if (taken.kind == Kind::Present) {
    visit_.stay();
  } else {  // what filters find that began before is no change of what is taken
    visit_.come_to_another();
    learned.for_each([](std::size_t /*i*/, RememberingAverage& average) { average.forget_recent(); });
  }
  heard_.end_trial(taken.kind != Kind::Present);
  const std::string name = labels_.judge(taken, recalled, decision.sure, surfaces_);
  surfaces_.take({.kind = event_of(taken.kind), .name = name, .probability = probability, .segments = segments},
                 settings_.most);
  if (!surfaces_.present()) {
    let_go();
  }
}

}  // namespace slipwise
