// SPDX-License-Identifier: Apache-2.0
// What the products of a slip program are multiplied by.
#pragma once

#include <cstddef>
#include <cstdint>

#include "slipwise/lie/lane_function.hpp"

namespace slipwise {

/// `Moving` is 1, and 0 where a robot is parked: gravity that is constant over a rollout goes into a product's
/// fractions, but must not move a parked robot. On a grade gravity turns with the heading and is a factor.
enum class SlipFactor : std::uint8_t {
  V,
  Omega,
  AbsV,
  AbsOmega,
  SignV,
  Curvature,
  Moving,
  GravityX,
  GravityY,
  SideV,
  AbsSideV,
  ThirdHarmonic
};
inline constexpr std::size_t kSlipFactors = 12;

SLIPWISE_LANES constexpr unsigned bit(SlipFactor factor) { return 1U << static_cast<unsigned>(factor); }

/// The products that every program starts with: V, omega and 1; the others follow, first Vy where the robot drives
/// sideways.
inline constexpr std::size_t kProductV = 0, kProductOmega = 1, kProductOne = 2, kFirstProduct = 3;
inline constexpr std::size_t kProductSideV = kFirstProduct;
inline constexpr std::size_t kMostProducts = 64;

}  // namespace slipwise
