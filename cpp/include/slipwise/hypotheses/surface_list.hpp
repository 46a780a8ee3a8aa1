// SPDX-License-Identifier: Apache-2.0
// The surfaces that are remembered: their names, which one is driven on, which go.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "slipwise/hypotheses/surface.hpp"

namespace slipwise {

/// What happened to a surface.
struct SurfaceEvent {
  enum class Kind : std::uint8_t { Opened, Recalled, Kept, Merged, Dropped };
  friend constexpr std::size_t enumerators(Kind /*type*/) { return 5; }
  Kind kind;
  std::string name;
  std::string other = {};    ///< that was merged into it
  double probability = 1.0;  ///< of the surface, when it was taken
  int segments = 0;          ///< that spoke before it was taken
};

/// Places are those of `all`; they change where surfaces are merged or dropped.
class SurfaceList {
 public:
  const std::vector<Surface>& all() const { return surfaces_; }
  Surface& operator[](std::size_t place) { return surfaces_[place]; }
  const Surface& operator[](std::size_t place) const { return surfaces_[place]; }
  std::size_t size() const { return surfaces_.size(); }
  /// The one that is driven on; empty if that is open, or it has no entry yet.
  std::optional<std::size_t> present() const { return present_; }
  /// Its name; empty where there is none.
  std::string present_name() const { return present_ ? surfaces_[*present_].name : ""; }
  /// The name of a candidate; empty where it has none, as one that changed: it becomes another when it is taken.
  std::string name_of(const SurfaceCandidate& candidate) const;

  /// The place of the one of this name; `size` where there is none.
  std::size_t place_of(const std::string& name) const;
  bool taken(const std::string& name) const { return place_of(name) < size(); }
  /// Whether a surface was not named, but given a number.
  static bool numbered(const std::string& name);

  /// Begins with surfaces that were learned before, the latest last.
  void know(std::vector<Surface> surfaces);
  /// Adds one of another memory; where its name is taken, with a number. Returns its name here.
  std::string add(Surface other);
  /// The one that is driven on gets an entry, with the name that is wanted where that is free.
  Surface& enter(const std::string& wanted);
  /// None is driven on that is known.
  void leave() { present_.reset(); }
  /// The same, and a new one is driven on, for which there is room among so many.
  void leave_for_new(std::size_t most);
  /// The one of the event's name is driven on again, a new one for which there is room among so many, or still the
  /// present one.
  void take(SurfaceEvent taken, std::size_t most);
  /// The older one keeps its name, unless only the newer one has a name of its own.
  void merge(std::size_t older_place, std::size_t newer_place);
  /// Until at most so many are left; never the present one.
  void drop_least_used(std::size_t most);

  /// What happened since the last call; the oldest are dropped where they wait for long.
  std::vector<SurfaceEvent> take_events() { return std::exchange(events_, {}); }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.surfaces_, self.present_, self.clock_, self.named_, self.events_);
  }

 private:
  void drop(std::size_t place);
  void say(SurfaceEvent event);

  std::vector<Surface> surfaces_;
  std::optional<std::size_t> present_;
  std::size_t clock_ = 0;  ///< surfaces taken so far
  std::size_t named_ = 0;  ///< surfaces that got a number for a name
  std::vector<SurfaceEvent> events_;
};

}  // namespace slipwise
