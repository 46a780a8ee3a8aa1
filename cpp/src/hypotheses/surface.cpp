// SPDX-License-Identifier: Apache-2.0
// Two surfaces that are one.
#include "slipwise/hypotheses/surface.hpp"

#include <algorithm>

namespace slipwise {
namespace {

/// What `more` and `less` know together; weights and noise are those of what was driven more.
SurfaceMemory joined(const SurfaceMemory& more, const SurfaceMemory& less) {
  SurfaceMemory both = more;
  for (std::size_t basis = 0; basis < both.slips.size(); ++basis) {
    both.slips[basis] = merged(both.slips[basis], less.slips[basis]);
  }
  return both;
}

}  // namespace

ReferenceSpeeds fastest(const ReferenceSpeeds& a, const ReferenceSpeeds& b) {
  return {.v = std::max(a.v, b.v), .omega = std::max(a.omega, b.omega)};
}

void take_in(Surface& older, const Surface& newer) {
  for (std::size_t k = 0; k < kAverages; ++k) {
    auto& mine = older.memories[k];
    const auto& its = newer.memories[k];
    if (mine && its) {
      mine = older.segments >= newer.segments ? joined(*mine, *its) : joined(*its, *mine);
    }
  }
  older.seconds += newer.seconds;
  older.segments += newer.segments;
  older.visits += newer.visits;
  add_counts(newer.classes, older.classes);
  older.used = std::max(older.used, newer.used);
  older.last_seen = std::max(older.last_seen, newer.last_seen);
  older.speeds = fastest(older.speeds, newer.speeds);
}

}  // namespace slipwise
