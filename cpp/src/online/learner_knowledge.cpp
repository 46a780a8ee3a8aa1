// SPDX-License-Identifier: Apache-2.0
// What a learner knew at a time, nothing measured later being in it, and what changes that beside segments: sources of
// poses that are decided, a drive that begins, cues of terrain.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "slipwise/filter/body_force.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/learner_times.hpp"
#include "slipwise/online/motion_learner.hpp"

namespace slipwise {

MotionLearner::MotionLearner(const MotionLearner&) = default;
MotionLearner::MotionLearner(MotionLearner&&) noexcept = default;
MotionLearner& MotionLearner::operator=(const MotionLearner&) = default;
MotionLearner& MotionLearner::operator=(MotionLearner&&) noexcept = default;
MotionLearner::~MotionLearner() = default;

Knowledge MotionLearner::now_known(double until) const {
  const auto motion = hypotheses_.posterior();  // what predicts best may count the lateness of poses as a delay
  return {
      .until = until,
      .motion = motion,
      .slip = motion->structure == Structure::Baseline ? hypotheses_.slip_posterior() : motion,
      .disturbance = std::make_shared<const DisturbanceFilter>(disturbance_),
      .clock = motion->model.learned().clock_offset ? motion : hypotheses_.of(Structure::Cascaded),
      .sources = settings_.stream.sources.empty() ? nullptr : std::make_shared<const SourceNoise>(sources_.noise())};
}

/// What was known, where a force was, with the force as it is expected amid a segment.
std::shared_ptr<const MotionPosterior> MotionLearner::aged(const Knowledge& known, const Segment& segment) const {
  const BodyForce force(known.motion->model.basis(), settings_.hypotheses.filter.force);
  if (!force.learned() || !std::isfinite(known.until)) {
    return known.motion;
  }
  MotionPosterior later = *known.motion;
  const double amid = 0.5 * (segment.start + segment.end);
  const double spoken = known.until - 0.5 * settings_.stream.segment_length;  // the middle of the last segment
  force.pass(later.estimate, std::max(amid - spoken, 0.0));
  return std::make_shared<const MotionPosterior>(std::move(later));
}

/// By the present estimate of the slip: where the baseline predicts best, by the best model that has some.
void MotionLearner::learn_source() {
  auto item = std::get<SourceSegment>(std::move(waiting_.front()));
  waiting_.pop_front();
  const double start = item.driven.segment.start;
  KnownSources::Found found = sources_.see(*known_.newest().slip, std::move(item));
  if (found.poor) {
    reject({Stream::Pose, Reason::PoorPose, start});
  }
  waiting_.insert(waiting_.begin(), std::make_move_iterator(found.learned.begin()),
                  std::make_move_iterator(found.learned.end()));
}

/// At the end of a run no better source can come any more.
void MotionLearner::finish_sources() {
  if (settings_.stream.sources.empty()) {
    return;
  }
  for (DrivenSegment& segment : sources_.finish()) {
    segment.known_at = std::max(segment.known_at, stream_.newest());
    waiting_.emplace_back(std::move(segment));
  }
  work_through();
}

void MotionLearner::forget(double fraction) {
  if (!(fraction >= 0.0) || !(fraction <= 1.0)) {
    throw std::invalid_argument("what is forgotten is a fraction between 0 and 1, got " + std::to_string(fraction));
  }
  work_through();  // what waits was driven on the terrain that is forgotten
  hypotheses_.forget(fraction);
  known_.replace(now_known(known_.newest().until));
}

void MotionLearner::start_drive(const DriveStart& start) {
  end_run();
  const std::size_t run = runs_;
  const double ended = stream_.newest();
  start_run();
  hypotheses_.start_drive(disturbance_.law(), start);
  note_surfaces(run, ended);
  known_.replace(now_known(known_.newest().until));
}

/// Without a memory there is nothing to recall, and slip may jump.
void MotionLearner::cue_surface(const std::string& label) {
  const bool remember = settings_.hypotheses.average.surfaces.remember;
  if (!remember && !label.empty()) {
    return;
  }
  work_through();  // what waits was driven on the surface before
  if (remember) {
    hypotheses_.cue_surface(disturbance_.law(), label);
    note_surfaces(runs_, stream_.newest());
  } else {
    hypotheses_.expect_change();
  }
  known_.replace(now_known(known_.newest().until));
}

void MotionLearner::cue_terrain(const TerrainAnswer& answer) {
  check_answer(answer);
  work_through();  // what waits was driven before
  hypotheses_.hear_terrain(disturbance_.law(), answer);
  note_surfaces(runs_, stream_.newest());
  known_.replace(now_known(known_.newest().until));
}

void MotionLearner::begin_with(const KnownBefore& known, const DisturbanceModel& law, bool wheels) {
  hypotheses_.begin_with(known, settings_.stream.segment_length, wheels);
  if (settings_.learn_disturbance) {
    disturbance_.begin_with(law);
  }
  note_surfaces(runs_, stream_.newest());
  known_.replace(now_known(known_.newest().until));
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
  log_.say(hypotheses_.take_surface_events(), run, clock_.stamp(t));
}

SurfaceBank MotionLearner::surfaces() const {
  const MotionLearner complete = completed();
  return complete.hypotheses_.surfaces_now(complete.disturbance_.law());
}

}  // namespace slipwise
