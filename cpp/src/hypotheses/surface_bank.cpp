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

template <class Use>
void for_each(const Averages& averages, const Use& use) {
  for (std::size_t i = 0; i < averages.size(); ++i) {
    if (averages[i] != nullptr) {
      use(i, *averages[i]);
    }
  }
}

}  // namespace

void Driven::see(const InputHistory& inputs, const Segment& segment) {
  seconds += segment.end - segment.start;
  ++segments;
  speeds.see(inputs, segment);
}

void Driven::take_in(const Driven& later) {
  if (later.segments > 0) {
    seconds += later.seconds;
    segments += later.segments;
    speeds.begin_with(later.speeds.reference(), later.seconds);
  }
}

SurfaceBank::SurfaceBank(const SurfaceSettings& settings) : settings_(settings) {}

void SurfaceBank::see(const InputHistory& inputs, const Segment& segment) {
  if (!settings_.remember) {
    return;
  }
  (trial_ && !held_ ? driven_in_trial_ : driven_).see(inputs, segment);
}

/// What was driven since it was taken is counted.
void SurfaceBank::flush(Surface& surface) {
  if (driven_.segments > 0) {
    surface.speeds = fastest(surface.speeds, driven_.speeds.reference());
  }
  surface.seconds += driven_.seconds;
  surface.segments += driven_.segments;
  surface.last_seen = date_.empty() ? surface.last_seen : date_;
  add_visit(heard_, surface.classes);
  heard_.clear();
  driven_ = {};
}

/// As it is now; a surface that was hardly driven is not kept.
void SurfaceBank::keep_present(const Averages& averages, const DisturbanceModel& law) {
  if (!settings_.remember) {
    return;
  }
  for_each(averages, [](std::size_t /*i*/, RememberingAverage& average) { average.mark_parting(kNow); });
  driven_.take_in(std::exchange(driven_in_trial_, {}));
  leave_present(averages, law);
}

/// What was known of the present surface at parting is remembered.
void SurfaceBank::leave_present(const Averages& averages, const DisturbanceModel& law) {
  const int fewest = wanted_.empty() ? settings_.fewest : settings_.soonest;  // a label says that there is one
  if (!surfaces_.present() && std::cmp_less(driven_.segments, fewest)) {
    return;
  }
  Surface& surface =
      surfaces_.present() ? surfaces_[*surfaces_.present()] : surfaces_.enter(std::exchange(wanted_, {}));
  flush(surface);
  for_each(averages, [&](std::size_t i, RememberingAverage& average) {
    const auto& parting = average.parting();
    surface.memories[i] = parting ? *parting : average.average().remember();
  });
  merge_confounded(averages, law, slipwise::present(surfaces_.present()));
}

void SurfaceBank::merge_confounded(const Averages& averages, const DisturbanceModel& law, std::size_t place) {
  if (!settings_.merge) {
    return;
  }
  const RememberingAverage& leader = *averages[leader_];
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
        leader.apart(slipwise::present(own.memories[leader_]), slipwise::present(other.memories[leader_]), law) <=
            told_apart) {
      surfaces_.merge(std::min(i, place), std::max(i, place));
      return;
    }
  }
}

void SurfaceBank::know(std::vector<Surface> surfaces, const LabelCounts& labels) {
  surfaces_.know(std::move(surfaces));
  labels_ = labels;
}

std::vector<std::string> SurfaceBank::add(const Averages& averages, const DisturbanceModel& law,
                                          std::vector<Surface> others, std::size_t leader) {
  leader_ = trial_ ? leader_ : leader;
  std::vector<std::string> names;
  for (Surface& other : others) {
    names.push_back(surfaces_.add(std::move(other)));
    merge_confounded(averages, law, surfaces_.size() - 1);
  }
  surfaces_.drop_least_used(settings_.most);
  return names;
}

void SurfaceBank::open(const Averages& averages, const DisturbanceModel& law, std::vector<SurfaceCandidate> candidates,
                       double since) {
  weigh_by_label(candidates);
  heard_in_trial_.clear();
  heard_factors_.assign(candidates.size(), 0.0);
  for_each(averages, [&](std::size_t /*i*/, RememberingAverage& average) { average.mark_parting(since); });
  const RememberingAverage& leader = *averages[leader_];
  std::vector<SurfaceMemory> known;
  for (const Surface& surface : surfaces_.all()) {  // an average that began later has not learned the older ones
    const auto& memory = surface.memories[leader_];
    known.push_back(memory ? *memory : leader.average().remember());
  }
  trial_.emplace(std::move(candidates), known, leader, law, since);
}

/// Slip may be that of the candidates that are known. The present one is what goes on.
void SurfaceBank::recall(const Averages& averages) const {
  const SurfaceTrial& trial = slipwise::present(trial_);
  for_each(averages, [&](std::size_t i, RememberingAverage& average) {
    std::vector<RecalledSurface> known;
    for (std::size_t k = 0; k < trial.candidates().size(); ++k) {
      const SurfaceCandidate& each = trial.candidates()[k];
      if (each.kind == Kind::Known && each.place != surfaces_.present() && surfaces_[each.place].memories[i]) {
        known.push_back({.memory = *surfaces_[each.place].memories[i],
                         .probability = trial.probabilities()[static_cast<Eigen::Index>(k)]});
      }
    }
    average.average().recall(known);
  });
}

/// What is said before any segment speaks counts for predictions too.
void SurfaceBank::weigh_trial(const Averages& averages, const Eigen::VectorXd& log_factors) {
  SurfaceTrial& trial = slipwise::present(trial_);
  trial.weigh(log_factors);
  if (trial.segments() == 0) {
    recall(averages);
  }
}

void SurfaceBank::start_drive(const Averages& averages, const DisturbanceModel& law, const DriveStart& start) {
  if (!settings_.remember) {
    return;
  }
  let_go();
  if (trial_) {
    settle(averages, law, true);
    let_go();
  }
  keep_present(averages, law);
  date_ = start.date;
  label_ = start.label;
  wanted_ = surfaces_.size() == 0 ? label_ : "";
  heard_.clear();
  doubted_for_.clear();
  if (surfaces_.size() > 0) {
    open(averages, law, candidates_of_start(surfaces_.size(), settings_), kNow);
    recall(averages);
    surfaces_.leave();
  }
}

/// Something says that the surface may be another from now on.
void SurfaceBank::suspect(const Averages& averages, const DisturbanceModel& law) {
  const bool doubted = held_;
  let_go();
  if (surfaces_.size() > 0) {  // what it parts from is what was known before the suspicion
    open(averages, law, candidates_of_change(surfaces_.size(), surfaces_.present(), doubted, settings_), kNow);
  }
  for_each(averages, [](std::size_t /*i*/, RememberingAverage& average) { average.average().expect_change(); });
  if (trial_) {
    recall(averages);
  }
}

bool SurfaceBank::consider(const Averages& averages, std::size_t leader, const DisturbanceModel& law) {
  if (!settings_.remember) {
    return false;
  }
  const auto changed_since = averages[leader]->take_change();
  if (trial_) {
    trial_->follow(*averages[leader_]);
    if (!held_) {
      return settle(averages, law, false);
    }
    if (!changed_since) {
      return doubt();
    }
  }
  const bool doubted = held_;
  let_go();
  leader_ = leader;
  if (!changed_since) {
    return false;
  }
  if (surfaces_.size() > (surfaces_.present() ? 1 : 0)) {
    label_.clear();
    open(averages, law, candidates_of_change(surfaces_.size(), surfaces_.present(), doubted, settings_),
         *changed_since);
    return false;
  }
  for_each(averages, [&](std::size_t /*i*/, RememberingAverage& average) { average.mark_parting(*changed_since); });
  leave_present(averages, law);
  enter_new();
  return false;
}

/// A surface that was recalled turns out to be another, which is like it but for a jump. Whether it did.
bool SurfaceBank::doubt() {
  const SurfaceTrial& trial = slipwise::present(trial_);
  const double another = trial.probabilities()[1];
  const int segments = trial.segments();
  if (another >= 1.0 - settings_.false_alarm) {
    --surfaces_[slipwise::present(surfaces_.present())].visits;
    let_go();
    wanted_ = !label_.empty() && !surfaces_.taken(label_) ? label_ : "";
    take({.kind = Kind::New}, "", another, segments);
    return true;
  }
  if (segments >= settings_.trial) {
    let_go();
  }
  return false;
}

/// What was recalled is no longer doubted.
void SurfaceBank::let_go() {
  if (held_) {
    trial_.reset();
    held_ = false;
  }
}

/// One that has no entry yet gets one when it is left.
void SurfaceBank::enter_new() {
  doubted_for_.clear();
  surfaces_.leave_for_new(settings_.most);
}

/// Takes a candidate where it is certain enough, or time is over, or at once. Whether one was taken. A known surface is
/// doubted until time is over.
bool SurfaceBank::settle(const Averages& averages, const DisturbanceModel& law, bool at_once) {
  SurfaceTrial& trial = slipwise::present(trial_);
  const auto& candidates = trial.candidates();
  const bool at_start = candidates.front().kind != Kind::Present;
  const SurfaceDecision decision = trial.decide(label_factors(candidates), settings_);
  if (!at_once && !decision.sure && trial.segments() < settings_.trial) {
    return false;
  }
  const bool another = decision.another > decision.probability;
  SurfaceCandidate taken = candidates[decision.known];
  double probability = decision.probability;
  const bool named = taken.kind == Kind::Known && surfaces_[taken.place].name == label_;
  const bool labelled = at_once && !label_.empty() && (another ? !surfaces_.taken(label_) : named);
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
    leave_present(averages, law);
  }
  if (taken.kind == Kind::Present) {
    driven_.take_in(std::exchange(driven_in_trial_, {}));
  } else {  // what filters find that began before is no change of what is taken
    driven_ = std::exchange(driven_in_trial_, {});
    for_each(averages, [](std::size_t /*i*/, RememberingAverage& average) { average.forget_recent(); });
  }
  hear_on(taken.kind);
  take(taken, judge_label(taken, recalled, decision.sure), probability, segments);
  if (!surfaces_.present()) {
    let_go();
  }
  return true;
}

/// Counts and says what was taken.
void SurfaceBank::take(const SurfaceCandidate& candidate, const std::string& recalled, double probability,
                       int segments) {
  SurfaceEvent event{.kind = SurfaceEvent::Kind::Kept,
                     .name = surfaces_.present_name(),
                     .probability = probability,
                     .segments = segments};
  if (candidate.kind == Kind::Known) {
    event.kind = SurfaceEvent::Kind::Recalled;
    event.name = recalled;
    const std::size_t place = surfaces_.place_of(recalled);
    if (place < surfaces_.size()) {  // else it was merged into the one that was left, and that one is driven on
      surfaces_.come_to(place);
    }
  } else if (candidate.kind != Kind::Present) {
    event.kind = SurfaceEvent::Kind::Opened;
    event.name = "";
    enter_new();
  }
  surfaces_.say(std::move(event));
}

}  // namespace slipwise
