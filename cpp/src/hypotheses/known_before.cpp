// SPDX-License-Identifier: Apache-2.0
// The surfaces that structures share, and how learning goes on from what another learner knew: its robot and its
// surfaces (derivations/surfaces.md).
#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "slipwise/hypotheses/motion_hypotheses.hpp"
#include "slipwise/linear/present.hpp"

namespace slipwise {
namespace {

std::size_t place_of(const MotionPosterior& model) {
  if (model.structure == Structure::Direct) {
    return kDirect;
  }
  return model.model.learned().response ? kCascaded : kJoint;
}

}  // namespace

/// What one structure remembers is what the others begin with: the slip is the same.
Surface MotionHypotheses::completed(const KnownSurface& known, std::size_t place) const {
  Surface surface = known.facts;
  const auto averages = averages_of(*this);
  for (std::size_t i = 0; i < kAverages; ++i) {
    surface.memories[i].reset();
    if (averages[i] != nullptr) {
      surface.memories[i] = averages[i]->average().completed(known.memory, i == place);
    }
  }
  return surface;
}

/// Lags behind limits of the drive are not those that are learned without: of such a model, these begin again.
void MotionHypotheses::begin_with(const KnownBefore& known, double segment_length, bool wheels_known) {
  const MotionPosterior& model = known.model;
  const std::size_t place = place_of(model);
  const Averages averages = averages_of(*this);
  if (count_ > 0 || known.surfaces.empty()) {
    throw std::invalid_argument("a learner begins with surfaces before it has learned anything");
  }
  if (averages[place] == nullptr) {
    throw std::invalid_argument("the surfaces were learned by a structure that is not tried");
  }
  if (cascaded_ && wheels_known && !tried(Structure::Cascaded)) {
    join_cascade();
  }
  const bool limited = model.structure == Structure::Limited;
  if (!limited) {
    averages[place]->average().know_robot(model.model, model.estimate);
  }
  if (place == kCascaded && !limited && cascaded_) {
    const std::vector<ParameterInfo> names = cascaded_->actuator_model().parameters();
    cascaded_->begin_with(
        known_by_name(names,
                      prior_estimate(cascaded_->actuator_model(), {.v = 1.0, .omega = 1.0}, settings_.filter.prior),
                      model.model, model.estimate),
        settings_.filter);
  }
  std::vector<Surface> surfaces;
  std::ranges::transform(known.surfaces, std::back_inserter(surfaces),
                         [&](const KnownSurface& each) { return completed(each, place); });
  double seconds = 0.0;
  std::ranges::for_each(surfaces, [&](const Surface& each) { seconds += each.seconds; });
  for (std::size_t i = 0; i < kAverages; ++i) {
    if (averages[i] != nullptr) {
      averages[i]->begin_on(slipwise::present(surfaces.back().memories[i]), seconds, segment_length);
    }
  }
  if (cascaded_) {
    cascaded_->restart();
    cascaded_->refresh();
  }
  bank_.know(std::move(surfaces), known.labels);
  constexpr std::array kOwn{Structure::Joint, Structure::Direct, Structure::Cascaded};
  begun_with_ = kOwn[place];
  favour_known();
}

std::vector<std::string> MotionHypotheses::add_surfaces(const DisturbanceModel& law, const KnownBefore& other) {
  const std::size_t place = place_of(other.model);
  std::vector<Surface> surfaces;
  std::ranges::transform(other.surfaces, std::back_inserter(surfaces),
                         [&](const KnownSurface& each) { return completed(each, place); });
  return bank_.add(learned_slip(law), std::move(surfaces));
}

std::optional<SlipOnSurface> MotionHypotheses::on_surface(const Surface& surface, Structure structure) const {
  constexpr std::array kPlaces{kJoint, kCascaded, kJoint, kDirect, kJoint};
  std::size_t place = kPlaces[static_cast<std::size_t>(structure)];
  if (structure == Structure::Limited && cascaded_ && tried(Structure::Cascaded)) {
    place = kCascaded;  // what is behind limits is what the cascade learns, where there is one
  }
  const RememberingAverage* average = averages_of(*this)[place];
  const auto& memory = surface.memories[place];
  if (average == nullptr || !memory || structure == Structure::Baseline) {
    return std::nullopt;
  }
  const SurfaceMemory own = average->average().remember();
  const auto same_size = [](const SurfaceSlip& a, const SurfaceSlip& b) {
    return a.mean.size() == b.mean.size() && a.robot.size() == b.robot.size();
  };
  if (!std::ranges::equal(own.slips, memory->slips, same_size)) {
    throw std::invalid_argument("the surface is of a learner with other terms");
  }
  SlipOnSurface found{
      .state = average->average().state_on(*memory), .memory = {.bases = {}, .memory = *memory}, .prior_speeds = {}};
  for (std::size_t i = 0; i < memory->slips.size(); ++i) {
    found.memory.bases.push_back(place == kDirect ? settings_.bases[static_cast<std::size_t>(direct_bases_[i])].name()
                                                  : settings_.bases[i].name());
  }
  found.prior_speeds = memory->slips.back().speeds;
  return found;
}

std::optional<SlipOnSurface> MotionHypotheses::slip_now(Structure structure) const {
  Surface here;
  const auto averages = averages_of(*this);
  for (std::size_t i = 0; i < kAverages; ++i) {
    if (averages[i] != nullptr) {
      here.memories[i] = averages[i]->average().remember();
    }
  }
  return on_surface(here, structure);
}

/// What learns slip behind measured wheel speeds tells surfaces apart soonest.
LearnedSlip MotionHypotheses::learned_slip(const DisturbanceModel& law) {
  LearnedSlip found{.averages = averages_of(*this), .leader = kJoint, .law = law};
  if (!tried(Structure::Direct)) {
    found.averages[kDirect] = nullptr;
  }
  if (cascaded_ && tried(Structure::Cascaded)) {
    found.leader = kCascaded;
  } else {
    found.averages[kCascaded] = nullptr;
  }
  return found;
}

void MotionHypotheses::start_run() {
  if (cascaded_) {
    cascaded_->restart();
  }
  if (settings_.average.surfaces.remember) {
    for (RememberingAverage* average : averages_of(*this)) {
      if (average != nullptr) {
        average->forget_recent();
      }
    }
  }
}

void MotionHypotheses::start_drive(const DisturbanceModel& law, const DriveStart& start) {
  bank_.start_drive(learned_slip(law), start);
  if (cascaded_) {
    cascaded_->restart();
    cascaded_->refresh();
  }
}

SurfaceBank MotionHypotheses::surfaces_now(const DisturbanceModel& law) const {
  MotionHypotheses now = *this;
  now.bank_.keep_present(now.learned_slip(law));
  return now.bank_;
}

}  // namespace slipwise
