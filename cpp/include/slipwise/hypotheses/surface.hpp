// SPDX-License-Identifier: Apache-2.0
// A surface that was driven on: what it is called, how much was driven, and what is remembered of its slip.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "slipwise/filter/driven_speeds.hpp"
#include "slipwise/hypotheses/surface_classes.hpp"
#include "slipwise/hypotheses/surface_memory.hpp"

namespace slipwise {

/// The averages of one learner, each of which remembers every surface in its own terms; empty where one is not tried.
inline constexpr std::size_t kAverages = 3;
inline constexpr std::size_t kJoint = 0, kDirect = 1, kCascaded = 2;  ///< which is whose

struct Surface {
  std::string name;
  double seconds = 0.0;        ///< driven on it
  std::size_t segments = 0;    ///< learned on it
  std::size_t visits = 0;      ///< times that the robot came to it
  std::string last_seen = {};  ///< date, as the drive's start was given it
  ReferenceSpeeds speeds{};    ///< covered
  std::size_t used = 0;        ///< drive or change, counted, at which it was taken last
  std::array<std::optional<SurfaceMemory>, kAverages> memories = {};  ///< per average
  ClassCounts classes = {};  ///< of terrain that sensors named on it, in visits
};

/// The faster of each.
ReferenceSpeeds fastest(const ReferenceSpeeds& a, const ReferenceSpeeds& b);

/// What was driven and learned on `newer` was on `older`, whose name it keeps.
void take_in(Surface& older, const Surface& newer);

}  // namespace slipwise
