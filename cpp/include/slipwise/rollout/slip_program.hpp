// SPDX-License-Identifier: Apache-2.0
// A slip basis with its parameters as a short program: products that build on each other, and their fractions per
// channel.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "slipwise/rollout/lane_job.hpp"
#include "slipwise/rollout/slip_factor.hpp"

namespace slipwise {

class Basis;

/// An earlier product times a factor.
struct SlipProduct {
  std::size_t parent;  ///< its place in the program
  SlipFactor factor;
  std::array<double, 3> fraction{};  ///< coefficient in the rates (forward [m/s], left [m/s], yaw [rad/s])
};

/// The robot's twist as a sum of products: the slip, and the drive itself.
struct SlipProgram {
  std::vector<SlipProduct> products;
  unsigned factors = 0;  ///< bits of those in use
};

/// Where the program's products stand if it is of second degree in speed and curvature (thesis 5.1), beside the drive.
std::optional<LaneQuadratic> find_quadratic(const SlipProgram& program);

/// Products that several terms share are computed once.
/// \param alpha the slip parameters in basis order. \param gravity along the body's x and y axes [m/s^2]; without one
/// it turns with the heading and is a factor.
/// \throws std::invalid_argument when the basis needs more products than a kernel has room for.
/// \param sideways whether the robot drives sideways too; otherwise no term has a sideways speed.
SlipProgram compile_slip(const Basis& basis, std::span<const double> alpha,
                         const std::optional<std::array<double, 2>>& gravity, bool sideways);

}  // namespace slipwise
