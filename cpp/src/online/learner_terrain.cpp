// SPDX-License-Identifier: Apache-2.0
// What a learner does about terrain when it is told: it forgets a part, begins a drive, or recalls a surface.
#include <stdexcept>
#include <string>
#include <vector>

#include "slipwise/online/motion_learner.hpp"

namespace slipwise {

void MotionLearner::forget(double fraction) {
  if (!(fraction >= 0.0) || !(fraction <= 1.0)) {
    throw std::invalid_argument("what is forgotten is a fraction between 0 and 1, got " + std::to_string(fraction));
  }
  work_through();  // what waits was driven on the terrain that is forgotten
  hypotheses_.forget(fraction);
  known_.back() = now_known(known_.back().until);
}

void MotionLearner::start_drive(const DriveStart& start) {
  start_run();
  hypotheses_.start_drive(disturbance_.law(), start);
  known_.back() = now_known(known_.back().until);
}

void MotionLearner::cue_surface(const std::string& label) {
  work_through();  // what waits was driven on the surface before
  hypotheses_.cue_surface(disturbance_.law(), label);
  known_.back() = now_known(known_.back().until);
}

void MotionLearner::begin_with(const KnownBefore& known, const DisturbanceModel& law, bool wheels) {
  hypotheses_.begin_with(known, settings_.stream.segment_length, wheels);
  if (settings_.learn_disturbance) {
    disturbance_.begin_with(law);
  }
  known_.back() = now_known(known_.back().until);
}

std::vector<std::string> MotionLearner::add_surfaces(const KnownBefore& other) {
  return hypotheses_.add_surfaces(disturbance_.law(), other);
}

void MotionLearner::consider_surfaces() { hypotheses_.consider_surfaces(disturbance_.law()); }

SurfaceBank MotionLearner::surfaces() const {
  MotionLearner complete = *this;
  complete.end_run();
  return complete.hypotheses_.surfaces_now(complete.disturbance_.law());
}

}  // namespace slipwise
