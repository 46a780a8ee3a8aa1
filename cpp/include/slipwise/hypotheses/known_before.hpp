// SPDX-License-Identifier: Apache-2.0
// Slip of surfaces in the terms of structures, and what another learner knew (derivations/surfaces.md).
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "slipwise/hypotheses/structures.hpp"
#include "slipwise/hypotheses/surface_bank.hpp"

namespace slipwise {

/// Slip of a surface in the terms of one structure.
struct SlipOnSurface {
  AverageState state;            ///< of the average of all bases
  NamedMemory memory;            ///< of each
  ReferenceSpeeds prior_speeds;  ///< of the prior under which it was learned
};

/// A surface that another learner knew.
struct KnownSurface {
  Surface facts;  ///< its memories are not used
  NamedMemory memory;
};

/// What a learner begins with: the model, surfaces and labels of another one.
struct KnownBefore {
  MotionPosterior model;
  std::vector<KnownSurface> surfaces;
  LabelCounts labels;
};

/// What surfaces are compared by: the averages of the structures that are tried.
LearnedSlip learned_slip(Structures& structures, const DisturbanceModel& law);

/// The estimate of a surface in the terms of a structure; empty if it has no memory.
/// \throws std::invalid_argument when the surface has other terms.
std::optional<SlipOnSurface> slip_on(const Structures& structures, const Surface& surface, Structure structure);
/// The same of the surface that is driven on, whether surfaces are remembered or not.
std::optional<SlipOnSurface> slip_now(const Structures& structures, Structure structure);

/// The average that learns as a model that was learned before.
std::size_t average_like(const MotionPosterior& model);
/// Surfaces of another learner in the terms of all averages: what one remembers, the others begin with.
std::vector<Surface> completed(const Structures& structures, const KnownBefore& known);
/// Begins with a robot that was learned before, by a structure that is tried.
void know_robot(Structures& structures, const MotionPosterior& robot);
/// Begins on the last of these surfaces, as if the robot had driven on all of them.
void begin_on(Structures& structures, const std::vector<Surface>& surfaces, double segment_length);

}  // namespace slipwise
