// SPDX-License-Identifier: Apache-2.0
// A segment piece by piece: each structure predicts it before any learns it.
#include "slipwise/hypotheses/motion_hypotheses.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "slipwise/linear/present.hpp"

namespace slipwise {
namespace {

std::size_t update_of(Structure structure) { return static_cast<std::size_t>(structure); }

}  // namespace

MotionHypotheses::MotionHypotheses(const HypothesisSettings& settings)
    : structures_(settings), bank_(settings.average.surfaces) {}

/// What was the best before begins as such, once it is tried.
void MotionHypotheses::join_cascade(bool wheels_known) {
  if (structures_.join_cascade(wheels_known) && begun_with_ == Structure::Cascaded) {
    structures_.favour(Structure::Cascaded);
  }
}

void MotionHypotheses::restart_cascade() {
  if (CascadedModel* cascade = structures_.cascaded(); cascade != nullptr) {
    cascade->restart();
    cascade->refresh();
  }
}

void MotionHypotheses::start(const DrivenSegment& segment, bool wheels_known) {
  join_cascade(wheels_known);
  segment_ = segment;
  to_predict_ = structures_.tried();
  predicted_.clear();
  std::ranges::for_each(updates_, [](StructureUpdate& update) { update.refitted = false; });
}

bool MotionHypotheses::advance() {
  if (!segment_) {
    return false;
  }
  if (predicted_.size() == to_predict_.size()) {
    end_segment();
    return false;
  }
  const DrivenSegment& driven = present(segment_);
  const Structure structure = to_predict_[predicted_.size()];
  RememberingAverage* average = structures_.average_of(structure);
  if (average == nullptr) {
    predicted_.push_back(structures_.score(structure, driven));
    updates_[update_of(structure)].nis = predicted_.back().nis;
  } else if (!averaging_) {
    average->start(driven.inputs, driven.segment);
    averaging_ = true;
  } else if (!average->advance()) {
    predicted_.push_back(learned(average->average(), structure));
    averaging_ = false;
  }
  return true;
}

ScoredSegment MotionHypotheses::learned(const ModelAverage& average, Structure structure) {
  const IekfUpdate& update = average.update();
  updates_[update_of(structure)] = {
      .nis = update.nis, .weight = update.weight, .change = average.change(), .refitted = average.refitted()};
  return {update.innovation, update.innovation_covariance, update.nis};
}

void MotionHypotheses::end_segment() {
  bank_.see(present(segment_).inputs, present(segment_).segment);
  if (CascadedModel* cascade = structures_.cascaded(); cascade != nullptr && structures_.tried(Structure::Cascaded)) {
    cascade->refresh();
    updates_[update_of(Structure::Cascaded)].change = cascade->change();
    updates_[update_of(Structure::Cascaded)].refitted = cascade->refitted();
  }
  structures_.learn(predicted_);
  ++count_;
  segment_.reset();
}

void MotionHypotheses::start_run() {
  if (CascadedModel* cascade = structures_.cascaded(); cascade != nullptr) {
    cascade->restart();
  }
  if (structures_.settings().average.surfaces.remember) {
    for (RememberingAverage* average : structures_.averages()) {
      if (average != nullptr) {
        average->forget_recent();
      }
    }
  }
}

void MotionHypotheses::start_drive(const DisturbanceModel& law, const DriveStart& start) {
  bank_.start_drive(learned_slip(structures_, law), start);
  restart_cascade();
}

void MotionHypotheses::begin_with(const KnownBefore& known, double segment_length, bool wheels_known) {
  if (count_ > 0 || known.surfaces.empty()) {
    throw std::invalid_argument("a learner begins with surfaces before it has learned anything");
  }
  const std::size_t place = average_like(known.model);
  if (structures_.averages()[place] == nullptr) {
    throw std::invalid_argument("the surfaces were learned by a structure that is not tried");
  }
  join_cascade(wheels_known);
  know_robot(structures_, known.model);
  std::vector<Surface> surfaces = completed(structures_, known);
  begin_on(structures_, surfaces, segment_length);
  restart_cascade();
  bank_.know(std::move(surfaces), known.labels);
  constexpr std::array kOwn{Structure::Joint, Structure::Direct, Structure::Cascaded};
  begun_with_ = kOwn[place];
  structures_.favour(kOwn[place]);
}

std::vector<std::string> MotionHypotheses::add_surfaces(const DisturbanceModel& law, const KnownBefore& other) {
  std::vector<Surface> surfaces = completed(structures_, other);
  return bank_.add(learned_slip(structures_, law), std::move(surfaces));
}

}  // namespace slipwise
