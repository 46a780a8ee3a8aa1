// SPDX-License-Identifier: Apache-2.0
// What a model average remembers of a surface, and which surfaces it takes into account at a change or a start.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "slipwise/filter/surface_slip.hpp"

namespace slipwise {

struct SurfaceSettings {
  bool remember = false;       ///< surfaces are kept, and recalled where they come back
  double false_alarm = 0.002;  ///< probability that is left to the others where a new surface is taken [-]
  double doubt = 0.02;         ///< the same, where a known one is taken [-]
  double drift = 0.003;        ///< of a surface since it was left, in prior variances of its slip [-]
  double learning_rate = 1.0;  ///< power of the joint density: below 1, since no model is true [-]
  int soonest = 2;             ///< segments that speak before a surface is taken, at least: one may be an outlier
  int trial = 60;              ///< segments after which the likeliest surface is taken, however close it is
  int fewest = 20;             ///< segments of a surface that is kept, or compared with others
  double changed = 0.2;   ///< prior probability that a jump of slip is another surface, not a passing disturbance [-]
  double unknown = 0.2;   ///< prior probability that the surface of a drive's start was never driven [-]
  bool merge = true;      ///< surfaces that cannot be distinguished become one:
  double alike = 600.0;   ///< in so many segments
  std::size_t most = 12;  ///< surfaces that are kept; the least used one goes
};

/// One model average's memory of a surface.
struct SurfaceMemory {
  std::vector<SurfaceSlip> slips;  ///< per basis
  Eigen::VectorXd weights;         ///< of the bases
  std::size_t observed = 0;        ///< segments weighted by
};

/// A surface that may be driven on from now on.
struct RecalledSurface {
  SurfaceMemory memory;
  double probability;
};

/// A memory whose bases are named, as a model file has it.
struct NamedMemory {
  std::vector<std::string> bases;  ///< one per slip of the memory
  SurfaceMemory memory;
};

/// What the surface under the robot may be.
struct SurfaceCandidate {
  enum class Kind : std::uint8_t {
    Present,  ///< the one before
    Changed,  ///< the one before, where slip jumped
    Known,    ///< one that is remembered
    Alike,    ///< like one that is remembered, but slip jumped
    New       ///< one that was never driven
  };
  friend constexpr std::size_t enumerators(Kind /*type*/) { return 5; }
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  Kind kind;
  std::size_t place = kNone;  ///< of the one that is remembered; the present one is else as it is known now
  double prior = 1.0;         ///< probability, of all candidates

  /// Whether it is a surface that was driven before.
  bool known() const { return kind == Kind::Present || kind == Kind::Known; }
};

}  // namespace slipwise
