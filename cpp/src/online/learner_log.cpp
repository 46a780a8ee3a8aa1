// SPDX-License-Identifier: Apache-2.0
// Events in the order in which they happened.
#include "slipwise/online/learner_log.hpp"

#include <iterator>
#include <utility>

namespace slipwise {
namespace {

constexpr std::size_t kMostEvents = 10000;
constexpr std::size_t kMostSurfaceEvents = 1000;

template <class Event>
std::vector<Event> taken(std::deque<Event>& waiting) {
  std::vector<Event> all(std::make_move_iterator(waiting.begin()), std::make_move_iterator(waiting.end()));
  waiting.clear();
  return all;
}

}  // namespace

void LearnerLog::say(LearnerEvent event) {
  event.run = run_;
  event.t = clock_.stamp(event.t);
  events_.push_back(std::move(event));
  if (events_.size() > kMostEvents) {
    events_.pop_front();
    ++dropped_;
  }
}

void LearnerLog::say(std::vector<SurfaceEvent> events, std::size_t run, double t) {
  for (SurfaceEvent& event : events) {
    surface_events_.push_back({.event = std::move(event), .run = run, .t = clock_.stamp(t)});
  }
  while (surface_events_.size() > kMostSurfaceEvents) {
    surface_events_.pop_front();
  }
}

void LearnerLog::reject(const Rejected& rejected) {
  ++rejected_[static_cast<std::size_t>(rejected.stream)][static_cast<std::size_t>(rejected.reason)];
  say({.kind = LearnerEvent::Kind::Rejected, .t = rejected.t, .stream = rejected.stream, .reason = rejected.reason});
}

std::vector<LearnerEvent> LearnerLog::take_events() { return taken(events_); }

std::vector<DatedSurfaceEvent> LearnerLog::take_surface_events() { return taken(surface_events_); }

}  // namespace slipwise
