// SPDX-License-Identifier: Apache-2.0
// How learning goes on from what another learner knew: its robot and its surfaces (derivations/surfaces.md).
#include "slipwise/hypotheses/known_before.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <stdexcept>

#include "slipwise/filter/prior.hpp"
#include "slipwise/linear/present.hpp"

namespace slipwise {
namespace {

/// What one structure remembers is what the others begin with: the slip is the same.
Surface completed(const Structures& structures, const KnownSurface& known, std::size_t place) {
  Surface surface = known.facts;
  const auto averages = structures.averages();
  for (std::size_t i = 0; i < kAverages; ++i) {
    surface.memories[i].reset();
    if (averages[i] != nullptr) {
      surface.memories[i] = averages[i]->average().completed(known.memory, i == place);
    }
  }
  return surface;
}

}  // namespace

std::size_t average_like(const MotionPosterior& model) {
  if (model.structure == Structure::Direct) {
    return kDirect;
  }
  return model.model.learned().response ? kCascaded : kJoint;
}

std::vector<Surface> completed(const Structures& structures, const KnownBefore& known) {
  std::vector<Surface> surfaces;
  std::ranges::transform(known.surfaces, std::back_inserter(surfaces), [&](const KnownSurface& each) {
    return completed(structures, each, average_like(known.model));
  });
  return surfaces;
}

/// Lags behind limits of the drive are not those that are learned without: of such a model, these begin again.
void know_robot(Structures& structures, const MotionPosterior& robot) {
  if (robot.structure == Structure::Limited) {
    return;
  }
  const std::size_t place = average_like(robot);
  structures.averages()[place]->average().know_robot(robot.model, robot.estimate);
  if (CascadedModel* cascade = structures.cascaded(); place == kCascaded && cascade != nullptr) {
    const CausalFilterSettings& filter = structures.settings().filter;
    const MotionModel& actuator = cascade->actuator_model();
    const Estimate prior = prior_estimate(actuator, {.v = 1.0, .omega = 1.0}, filter.prior);
    cascade->begin_with(known_by_name(actuator.parameters(), prior, robot.model, robot.estimate), filter);
  }
}

void begin_on(Structures& structures, const std::vector<Surface>& surfaces, double segment_length) {
  const auto averages = structures.averages();
  double seconds = 0.0;
  std::ranges::for_each(surfaces, [&](const Surface& each) { seconds += each.seconds; });
  for (std::size_t i = 0; i < kAverages; ++i) {
    if (averages[i] != nullptr) {
      averages[i]->begin_on(present(surfaces.back().memories[i]), seconds, segment_length);
    }
  }
}

std::optional<SlipOnSurface> slip_on(const Structures& structures, const Surface& surface, Structure structure) {
  constexpr std::array kPlaces{kJoint, kCascaded, kJoint, kDirect, kJoint};
  std::size_t place = kPlaces[static_cast<std::size_t>(structure)];
  if (structure == Structure::Limited && structures.tried(Structure::Cascaded)) {
    place = kCascaded;  // what is behind limits is what the cascade learns, where there is one
  }
  const RememberingAverage* average = structures.averages()[place];
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
  return SlipOnSurface{.state = average->average().state_on(*memory),
                       .memory = {.bases = structures.basis_names(place), .memory = *memory},
                       .prior_speeds = memory->slips.back().speeds};
}

std::optional<SlipOnSurface> slip_now(const Structures& structures, Structure structure) {
  Surface here;
  const auto averages = structures.averages();
  for (std::size_t i = 0; i < kAverages; ++i) {
    if (averages[i] != nullptr) {
      here.memories[i] = averages[i]->average().remember();
    }
  }
  return slip_on(structures, here, structure);
}

/// What learns slip behind measured wheel speeds tells surfaces apart soonest.
LearnedSlip learned_slip(Structures& structures, const DisturbanceModel& law) {
  LearnedSlip found{.averages = structures.averages(), .leader = kJoint, .law = law};
  if (!structures.tried(Structure::Direct)) {
    found.averages[kDirect] = nullptr;
  }
  if (structures.tried(Structure::Cascaded)) {
    found.leader = kCascaded;
  } else {
    found.averages[kCascaded] = nullptr;
  }
  return found;
}

}  // namespace slipwise
