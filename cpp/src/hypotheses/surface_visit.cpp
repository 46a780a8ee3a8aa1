// SPDX-License-Identifier: Apache-2.0
// Sums of what was driven.
#include "slipwise/hypotheses/surface_visit.hpp"

#include <utility>

namespace slipwise {

void SurfaceVisit::see(const InputHistory& inputs, const Segment& segment, bool in_trial) {
  Driven& driven = in_trial ? in_trial_ : here_;
  driven.seconds += segment.end - segment.start;
  ++driven.segments;
  driven.speeds.see(inputs, segment);
}

void SurfaceVisit::stay() {
  const Driven later = std::exchange(in_trial_, {});
  if (later.segments > 0) {
    here_.seconds += later.seconds;
    here_.segments += later.segments;
    here_.speeds.begin_with(later.speeds.reference(), later.seconds);
  }
}

void SurfaceVisit::come_to_another() { here_ = std::exchange(in_trial_, {}); }

void SurfaceVisit::leave(Surface& surface) {
  if (here_.segments > 0) {
    surface.speeds = fastest(surface.speeds, here_.speeds.reference());
  }
  surface.seconds += here_.seconds;
  surface.segments += here_.segments;
  surface.last_seen = date_.empty() ? surface.last_seen : date_;
  here_ = {};
}

}  // namespace slipwise
