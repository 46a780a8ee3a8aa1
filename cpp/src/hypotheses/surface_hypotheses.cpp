// SPDX-License-Identifier: Apache-2.0
// The structures and the surfaces that they share.
#include "slipwise/hypotheses/motion_hypotheses.hpp"
#include "slipwise/linear/present.hpp"

namespace slipwise {
Averages MotionHypotheses::averages() {
  Averages found = averages_of(*this);
  found[kDirect] = tried(Structure::Direct) ? found[kDirect] : nullptr;
  found[kCascaded] = tried(Structure::Cascaded) ? found[kCascaded] : nullptr;
  return found;
}

/// What learns slip behind measured wheel speeds tells surfaces apart soonest.
std::size_t MotionHypotheses::leader() const { return cascaded_ && tried(Structure::Cascaded) ? kCascaded : kJoint; }

void MotionHypotheses::start_run() {
  if (settings_.average.surfaces.remember) {
    for (ModelAverage* average : averages()) {
      if (average != nullptr) {
        average->start_run();
      }
    }
  }
}

void MotionHypotheses::start_drive(const DisturbanceModel& law, const DriveStart& start) {
  bank_.start_drive(averages(), law, start);
  if (cascaded_) {
    cascaded_->refresh();
  }
}

void MotionHypotheses::cue_surface(const DisturbanceModel& law, const std::string& label) {
  bank_.cue(averages(), law, label);
}

void MotionHypotheses::hear_terrain(const DisturbanceModel& law, const TerrainAnswer& answer) {
  bank_.hear(averages(), law, answer);
}

bool MotionHypotheses::consider_surfaces(const DisturbanceModel& law) {
  return bank_.consider(averages(), leader(), law);
}

SurfaceBank MotionHypotheses::surfaces_now(const DisturbanceModel& law) const {
  MotionHypotheses now = *this;
  now.bank_.keep_present(now.averages(), law);
  return now.bank_;
}

std::vector<SurfaceProbability> MotionHypotheses::probable_surfaces() const {
  if (!settings_.average.surfaces.remember) {
    return {};
  }
  const ModelAverage& first = leader() == kCascaded ? present(cascaded_).slip() : joint_;
  return surface_probabilities(bank_, first.trial());
}

}  // namespace slipwise
