// SPDX-License-Identifier: Apache-2.0
// Names are free or taken; what is used least goes.
#include "slipwise/hypotheses/surface_list.hpp"

#include <algorithm>
#include <string_view>

namespace slipwise {
namespace {

constexpr std::string_view kNumbered = "surface ";
constexpr std::size_t kMostEvents = 1000;

}  // namespace

std::size_t SurfaceList::place_of(const std::string& name) const {
  return static_cast<std::size_t>(std::ranges::find(surfaces_, name, &Surface::name) - surfaces_.begin());
}

std::string SurfaceList::name_of(const SurfaceCandidate& candidate) const {
  if (candidate.kind == SurfaceCandidate::Kind::Known) {
    return surfaces_[candidate.place].name;
  }
  return candidate.kind == SurfaceCandidate::Kind::Present ? present_name() : "";
}

bool SurfaceList::numbered(const std::string& name) {
  return name.starts_with(kNumbered) && name.find_first_not_of("0123456789 ()", kNumbered.size()) == std::string::npos;
}

void SurfaceList::know(std::vector<Surface> surfaces) {
  surfaces_ = std::move(surfaces);
  clock_ = surfaces_.size();
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    surfaces_[i].used = i + 1;
  }
}

std::string SurfaceList::add(Surface other) {
  const std::string wanted = other.name;
  for (int count = 2; taken(other.name); ++count) {
    other.name = wanted + " (" + std::to_string(count) + ")";
  }
  other.used = ++clock_;
  surfaces_.push_back(std::move(other));
  return surfaces_.back().name;
}

Surface& SurfaceList::enter(const std::string& wanted) {
  std::string name = wanted;
  while (name.empty() || taken(name)) {
    name = std::string(kNumbered) + std::to_string(++named_);
  }
  present_ = surfaces_.size();
  surfaces_.push_back({.name = name, .visits = 1, .used = ++clock_});
  say({.kind = SurfaceEvent::Kind::Opened, .name = name});
  return surfaces_.back();
}

void SurfaceList::leave_for_new(std::size_t most) {
  leave();
  ++clock_;
  drop_least_used(most - 1);
}

void SurfaceList::take(SurfaceEvent taken, std::size_t most) {
  const std::size_t place = place_of(taken.name);
  if (taken.kind == SurfaceEvent::Kind::Kept) {
    taken.name = present_name();
  } else if (taken.kind != SurfaceEvent::Kind::Recalled) {
    leave_for_new(most);
  } else if (place < size()) {  // else it was merged into the one that was left, and that one is driven on
    present_ = place;
    ++surfaces_[place].visits;
    surfaces_[place].used = ++clock_;
  }
  say(std::move(taken));
}

void SurfaceList::merge(std::size_t older_place, std::size_t newer_place) {
  Surface& older = surfaces_[older_place];
  Surface& newer = surfaces_[newer_place];
  if (numbered(older.name) && !numbered(newer.name)) {
    std::swap(older.name, newer.name);
  }
  say({.kind = SurfaceEvent::Kind::Merged, .name = older.name, .other = newer.name});
  take_in(older, newer);
  surfaces_.erase(surfaces_.begin() + static_cast<std::ptrdiff_t>(newer_place));
  if (present_ && *present_ == newer_place) {
    present_ = older_place;
  } else if (present_ && *present_ > newer_place) {
    --*present_;
  }
}

void SurfaceList::drop_least_used(std::size_t most) {
  while (surfaces_.size() > most) {
    const auto least = std::ranges::min_element(surfaces_, [](const Surface& a, const Surface& b) {
      return std::pair(a.visits, a.used) < std::pair(b.visits, b.used);
    });
    drop(static_cast<std::size_t>(least - surfaces_.begin()));
  }
}

void SurfaceList::drop(std::size_t place) {
  say({.kind = SurfaceEvent::Kind::Dropped, .name = surfaces_[place].name});
  surfaces_.erase(surfaces_.begin() + static_cast<std::ptrdiff_t>(place));
  if (present_ && *present_ > place) {
    --*present_;
  }
}

void SurfaceList::say(SurfaceEvent event) {
  events_.push_back(std::move(event));
  if (events_.size() > kMostEvents) {
    events_.erase(events_.begin());
  }
}

}  // namespace slipwise
