// SPDX-License-Identifier: Apache-2.0
// The slip terms by which a steady force shows: motion, per distance driven and per angle turned, that does not change
// sign with either (derivations/slopes-and-forces.md).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "slipwise/slip/basis.hpp"

namespace slipwise {

/// What a force stays fixed to: the robot, as a hitch's or a blade's, or the frame of the poses, as that of wind.
enum class ForceFrame : std::uint8_t { Body, World };
constexpr std::size_t enumerators(ForceFrame /*type*/) { return 2; }

/// Which part of the force a term answers to.
enum class ForceAxis : std::uint8_t { Ahead, Left, Moment, WorldX, WorldY };

/// A term of a force among those of a basis.
struct ForceTerm {
  Eigen::Index place;  ///< among the parameters
  ForceAxis axis;
  double sign;   ///< of what a positive force does to its channel
  bool turning;  ///< per angle turned, otherwise per distance driven
};

/// The basis with the terms of a force that it has not yet.
Basis with_force(const Basis& basis, ForceFrame frame);
/// The terms of a basis that are those of a force, whatever frame it is fixed to.
std::vector<ForceTerm> force_terms(const Basis& basis);

}  // namespace slipwise
