// SPDX-License-Identifier: Apache-2.0
// What a learner does about terrain on a call: it forgets a part, begins a drive, or recalls a surface.
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "slipwise/online/motion_learner.hpp"

namespace slipwise {
namespace {

constexpr std::size_t kMostEvents = 1000;  // that wait for a call

}  // namespace

void MotionLearner::forget(double fraction) {
  if (!(fraction >= 0.0) || !(fraction <= 1.0)) {
    throw std::invalid_argument("what is forgotten is a fraction between 0 and 1, got " + std::to_string(fraction));
  }
  work_through();  // what waits was driven on the terrain that is forgotten
  hypotheses_.forget(fraction);
  known_.back() = now_known(known_.back().until);
}

void MotionLearner::start_drive(const DriveStart& start) {
  end_run();
  const std::size_t run = runs_;
  const double ended = stream_.newest();
  start_run();
  hypotheses_.start_drive(disturbance_.law(), start);
  note_surfaces(run, ended);
  known_.back() = now_known(known_.back().until);
}

/// Without a memory there is nothing to recall: what is the terrain's becomes as unsure as after a suspicion.
void MotionLearner::cue_surface(const std::string& label) {
  const ModelAverageSettings& average = settings_.hypotheses.average;
  if (!average.surfaces.remember) {
    if (label.empty()) {
      forget(average.change.forget);
    }
    return;
  }
  work_through();  // what waits was driven on the surface before
  hypotheses_.cue_surface(disturbance_.law(), label);
  note_surfaces(runs_, stream_.newest());
  known_.back() = now_known(known_.back().until);
}

void MotionLearner::cue_terrain(const TerrainAnswer& answer) {
  check_answer(answer);
  work_through();  // what waits was driven before
  hypotheses_.hear_terrain(disturbance_.law(), answer);
  note_surfaces(runs_, stream_.newest());
  known_.back() = now_known(known_.back().until);
}

void MotionLearner::begin_with(const KnownBefore& known, const DisturbanceModel& law, bool wheels) {
  hypotheses_.begin_with(known, settings_.stream.segment_length, wheels);
  if (settings_.learn_disturbance) {
    disturbance_.begin_with(law);
  }
  note_surfaces(runs_, stream_.newest());
  known_.back() = now_known(known_.back().until);
}

std::vector<std::string> MotionLearner::add_surfaces(const KnownBefore& other) {
  std::vector<std::string> names = hypotheses_.add_surfaces(disturbance_.law(), other);
  note_surfaces(runs_, stream_.newest());
  return names;
}

void MotionLearner::consider_surfaces(double t) {
  hypotheses_.consider_surfaces(disturbance_.law());
  note_surfaces(runs_, t);
}

void MotionLearner::note_surfaces(std::size_t run, double t) {
  for (SurfaceEvent& event : hypotheses_.take_surface_events()) {
    surface_events_.push_back({.event = std::move(event), .run = run, .t = clock_.stamp(t)});
  }
  while (surface_events_.size() > kMostEvents) {
    surface_events_.pop_front();
  }
}

std::vector<DatedSurfaceEvent> MotionLearner::surface_events() {
  std::vector<DatedSurfaceEvent> events(std::make_move_iterator(surface_events_.begin()),
                                        std::make_move_iterator(surface_events_.end()));
  surface_events_.clear();
  return events;
}

SurfaceBank MotionLearner::surfaces() const {
  const MotionLearner complete = completed();
  return complete.hypotheses_.surfaces_now(complete.disturbance_.law());
}

}  // namespace slipwise
