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
constexpr std::size_t kMostEvents = 1000;

template <class Use>
void for_each(const Averages& averages, const Use& use) {
  for (std::size_t i = 0; i < averages.size(); ++i) {
    if (averages[i] != nullptr) {
      use(i, *averages[i]);
    }
  }
}

}  // namespace

SurfaceBank::SurfaceBank(const SurfaceSettings& settings) : settings_(settings) {}

std::vector<SurfaceEvent> SurfaceBank::take_events() { return std::exchange(events_, {}); }

void SurfaceBank::see(const InputHistory& inputs, const Segment& segment) {
  if (!settings_.remember) {
    return;
  }
  seconds_ += segment.end - segment.start;
  ++segments_;
  speeds_.see(inputs, segment);
}

/// What was driven since it was taken is counted.
void SurfaceBank::flush(Surface& surface) {
  if (segments_ > 0) {
    surface.speeds = fastest(surface.speeds, speeds_.reference());
  }
  surface.seconds += seconds_;
  surface.segments += segments_;
  surface.last_seen = date_.empty() ? surface.last_seen : date_;
  add_visit(heard_, surface.classes);
  heard_.clear();
  seconds_ = 0.0;
  segments_ = 0;
  speeds_ = {};
}

/// As it is now; a surface that was hardly driven is not kept.
void SurfaceBank::keep_present(const Averages& averages, const DisturbanceModel& law) {
  if (!settings_.remember) {
    return;
  }
  for_each(averages, [](std::size_t /*i*/, RememberingAverage& average) { average.mark_parting(kNow); });
  leave_present(averages, law);
}

/// What was known of the present surface at parting is remembered.
void SurfaceBank::leave_present(const Averages& averages, const DisturbanceModel& law) {
  if (!present_ && std::cmp_less(segments_, settings_.fewest)) {
    return;
  }
  const std::size_t place = present_ ? *present_ : surfaces_.size();
  if (!present_) {
    surfaces_.push_back({.name = new_name(), .visits = 1, .used = ++clock_});
    present_ = place;
    events_.push_back({.kind = SurfaceEvent::Kind::Opened, .name = surfaces_.back().name});
  }
  Surface& surface = surfaces_[place];
  flush(surface);
  for_each(averages, [&](std::size_t i, RememberingAverage& average) {
    const auto& parting = average.parting();
    surface.memories[i] = parting ? *parting : average.average().remember();
  });
  merge_confounded(averages, law, place);
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
    const bool named_apart = present_ && !numbered(own.name) && !numbered(other.name);
    if (i != place && !named_apart && known(own) && known(other) &&
        leader.apart(slipwise::present(own.memories[leader_]), slipwise::present(other.memories[leader_]), law) <=
            told_apart) {
      merge(std::min(i, place), std::max(i, place));
      return;
    }
  }
}

/// The older one keeps its name, unless only the newer one has a name of its own.
void SurfaceBank::merge(std::size_t older_place, std::size_t newer_place) {
  Surface& older = surfaces_[older_place];
  Surface& newer = surfaces_[newer_place];
  if (numbered(older.name) && !numbered(newer.name)) {
    std::swap(older.name, newer.name);
  }
  events_.push_back({.kind = SurfaceEvent::Kind::Merged, .name = older.name, .other = newer.name});
  take_in(older, newer);
  surfaces_.erase(surfaces_.begin() + static_cast<std::ptrdiff_t>(newer_place));
  if (present_ && *present_ == newer_place) {
    present_ = older_place;
  } else if (present_ && *present_ > newer_place) {
    --*present_;
  }
}

void SurfaceBank::know(std::vector<Surface> surfaces, const LabelCounts& labels) {
  surfaces_ = std::move(surfaces);
  labels_ = labels;
  clock_ = surfaces_.size();
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    surfaces_[i].used = i + 1;
  }
}

std::vector<std::string> SurfaceBank::add(const Averages& averages, const DisturbanceModel& law,
                                          std::vector<Surface> others, std::size_t leader) {
  leader_ = trial_ ? leader_ : leader;
  std::vector<std::string> names;
  for (Surface& other : others) {
    const std::string wanted = other.name;
    for (int count = 2; taken(other.name); ++count) {
      other.name = wanted + " (" + std::to_string(count) + ")";
    }
    other.used = ++clock_;
    surfaces_.push_back(std::move(other));
    names.push_back(surfaces_.back().name);
    merge_confounded(averages, law, surfaces_.size() - 1);
  }
  drop_least_used(settings_.most);
  return names;
}

/// Never the present one.
void SurfaceBank::drop(std::size_t place) {
  events_.push_back({.kind = SurfaceEvent::Kind::Dropped, .name = surfaces_[place].name});
  surfaces_.erase(surfaces_.begin() + static_cast<std::ptrdiff_t>(place));
  if (present_ && *present_ > place) {
    --*present_;
  }
}

void SurfaceBank::open(const Averages& averages, const DisturbanceModel& law, std::vector<SurfaceCandidate> candidates,
                       double since) {
  weigh_by_label(candidates);
  heard_in_trial_.clear();
  heard_factors_.assign(candidates.size(), 0.0);
  for_each(averages, [&](std::size_t /*i*/, RememberingAverage& average) { average.mark_parting(since); });
  const RememberingAverage& leader = *averages[leader_];
  std::vector<SurfaceMemory> known;
  for (const Surface& surface : surfaces_) {  // an average that began later has not learned the older ones
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
      if (each.kind == Kind::Known && each.place != present_ && surfaces_[each.place].memories[i]) {
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
  wanted_ = surfaces_.empty() ? label_ : "";
  heard_.clear();
  doubted_for_.clear();
  if (!surfaces_.empty()) {
    open(averages, law, candidates_of_start(surfaces_.size(), settings_), kNow);
    recall(averages);
    present_.reset();
  }
}

/// Something says that the surface may be another from now on.
void SurfaceBank::suspect(const Averages& averages, const DisturbanceModel& law) {
  const bool doubted = held_;
  let_go();
  if (!surfaces_.empty()) {  // what it parts from is what was known before the suspicion
    open(averages, law, candidates_of_change(surfaces_.size(), present_, doubted, settings_), kNow);
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
  if (surfaces_.size() > (present_ ? 1 : 0)) {
    label_.clear();
    open(averages, law, candidates_of_change(surfaces_.size(), present_, doubted, settings_), *changed_since);
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
    --surfaces_[slipwise::present(present_)].visits;
    let_go();
    wanted_ = !label_.empty() && !taken(label_) ? label_ : "";
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
  present_.reset();
  doubted_for_.clear();
  ++clock_;
  drop_least_used(settings_.most - 1);
}

/// Until at most so many are left.
void SurfaceBank::drop_least_used(std::size_t most) {
  while (surfaces_.size() > most) {
    const auto least = std::ranges::min_element(surfaces_, [](const Surface& a, const Surface& b) {
      return std::pair(a.visits, a.used) < std::pair(b.visits, b.used);
    });
    drop(static_cast<std::size_t>(least - surfaces_.begin()));
  }
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
  if (decision.sure ? another : at_start && (!named || another)) {  // or kept apart until it is known better
    taken = {.kind = Kind::New};
    probability = decision.another;
  } else if (!decision.sure && !at_start) {  // a suspicion that was not confirmed
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
  if (taken.kind != Kind::Present) {  // what filters find that began before is no change of what is taken
    for_each(averages, [](std::size_t /*i*/, RememberingAverage& average) { average.forget_recent(); });
  }
  hear_on(taken.kind);
  take(taken, judge_label(taken, recalled, decision.sure), probability, segments);
  if (!present_) {
    let_go();
  }
  return true;
}

/// Counts and says what was taken.
void SurfaceBank::take(const SurfaceCandidate& candidate, const std::string& recalled, double probability,
                       int segments) {
  SurfaceEvent event{.kind = SurfaceEvent::Kind::Kept,
                     .name = present_ ? surfaces_[*present_].name : "",
                     .probability = probability,
                     .segments = segments};
  if (candidate.kind == Kind::Known) {
    event.kind = SurfaceEvent::Kind::Recalled;
    event.name = recalled;
    const auto place = std::ranges::find(surfaces_, recalled, &Surface::name) - surfaces_.begin();
    if (place < std::ssize(surfaces_)) {  // else it was merged into the one that was left, and that one is driven on
      present_ = static_cast<std::size_t>(place);
      ++surfaces_[*present_].visits;
      surfaces_[*present_].used = ++clock_;
    }
  } else if (candidate.kind != Kind::Present) {
    event.kind = SurfaceEvent::Kind::Opened;
    event.name = "";
    enter_new();
  }
  events_.push_back(std::move(event));
  if (events_.size() > kMostEvents) {
    events_.erase(events_.begin());
  }
}

}  // namespace slipwise
