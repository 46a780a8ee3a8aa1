// SPDX-License-Identifier: Apache-2.0
// Lanes: several rollouts side by side in one vector of numbers, at the width that an instruction level has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#define SLIPWISE_LANES [[gnu::always_inline]] inline

namespace slipwise {

/// The vectors of a level: `Level::kBytes` wide, `Level::kVectors` of them in a block.
template <class Level, typename Scalar>
struct Lanes {
  typedef Scalar Vector __attribute__((vector_size(Level::kBytes)));  // NOLINT(modernize-use-using): takes no attribute
  static constexpr std::size_t kWidth = Level::kBytes / sizeof(Scalar);
  static constexpr std::size_t kVectors = Level::kVectors;
  static constexpr std::size_t kLanes = kWidth * kVectors;

  /// One number per rollout of a block.
  struct Row {
    Vector part[kVectors];
  };
};

template <class Vector, typename Scalar>
SLIPWISE_LANES void load(const Scalar* from, Vector& vector) {
  std::memcpy(&vector, from, sizeof(Vector));
}

template <class Vector, typename Scalar>
SLIPWISE_LANES void store(const Vector& vector, Scalar* to) {
  std::memcpy(to, &vector, sizeof(Vector));
}

}  // namespace slipwise
