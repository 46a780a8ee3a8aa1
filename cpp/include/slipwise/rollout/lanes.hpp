// SPDX-License-Identifier: Apache-2.0
// Lanes: several rollouts side by side in vectors of numbers, as wide as an instruction level has them.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>

#include "slipwise/lie/lane_function.hpp"

namespace slipwise {

/// Two vectors that are worked on together, so that what is read once serves both. Pairs of pairs are four.
template <class Half>
struct Pair {
  Half low;
  Half high;
};

template <typename Scalar, std::size_t kBytes>
struct NativeVector {
  typedef Scalar Type __attribute__((vector_size(kBytes)));  // NOLINT(modernize-use-using): takes no attribute
};

template <class Vector, std::size_t kPairs>
struct Paired {
  using Type = Pair<typename Paired<Vector, kPairs - 1>::Type>;
};
template <class Vector>
struct Paired<Vector, 0> {
  using Type = Vector;
};

/// One number per rollout of a block: `Level::kBytes` are a vector of the processor, paired `Level::kPairs` times.
template <class Level, typename Number>
struct Lanes {
  using Scalar = Number;
  using Vector = Paired<typename NativeVector<Scalar, Level::kBytes>::Type, Level::kPairs>::Type;
  static constexpr std::size_t kLanes = sizeof(Vector) / sizeof(Scalar);
};

/// A level with single vectors, for what pairs of them have no registers for.
template <class Level>
struct Unpaired {
  static constexpr std::size_t kBytes = Level::kBytes;
  static constexpr std::size_t kPairs = 0;
};

template <class Vector, typename Scalar>
SLIPWISE_LANES void load(const Scalar* from, Vector& vector) {
  if constexpr (std::is_same_v<Vector, Scalar>) {
    vector = *from;  // a GPU would copy it byte by byte
  } else {
    std::memcpy(&vector, from, sizeof(Vector));
  }
}
template <class Half, typename Scalar>
SLIPWISE_LANES void load(const Scalar* from, Pair<Half>& pair) {
  load(from, pair.low);
  load(from + sizeof(Half) / sizeof(Scalar), pair.high);
}

template <class Vector, typename Scalar>
SLIPWISE_LANES void store(const Vector& vector, Scalar* to) {
  if constexpr (std::is_same_v<Vector, Scalar>) {
    *to = vector;
  } else {
    std::memcpy(to, &vector, sizeof(Vector));
  }
}
template <class Half, typename Scalar>
SLIPWISE_LANES void store(const Pair<Half>& pair, Scalar* to) {
  store(pair.low, to);
  store(pair.high, to + sizeof(Half) / sizeof(Scalar));
}

/// Vector by vector. An assignment may copy a pair as bytes, in pieces that stall the vectors that are read next.
template <class Vector>
SLIPWISE_LANES void copy(const Vector& from, Vector& to) {
  to = from;
}
template <class Half>
SLIPWISE_LANES void copy(const Pair<Half>& from, Pair<Half>& to) {
  copy(from.low, to.low);
  copy(from.high, to.high);
}

template <class Vector, typename Scalar>
SLIPWISE_LANES void fill(Scalar value, Vector& vector) {
  vector = Vector{} + value;
}
template <class Half, typename Scalar>
SLIPWISE_LANES void fill(Scalar value, Pair<Half>& pair) {
  fill(value, pair.low);
  fill(value, pair.high);
}

template <class Half>
SLIPWISE_LANES Pair<Half> operator+(const Pair<Half>& a, const Pair<Half>& b) {
  return {a.low + b.low, a.high + b.high};
}
template <class Half>
SLIPWISE_LANES Pair<Half> operator-(const Pair<Half>& a, const Pair<Half>& b) {
  return {a.low - b.low, a.high - b.high};
}
template <class Half>
SLIPWISE_LANES Pair<Half> operator*(const Pair<Half>& a, const Pair<Half>& b) {
  return {a.low * b.low, a.high * b.high};
}
template <class Half>
SLIPWISE_LANES Pair<Half> operator/(const Pair<Half>& a, const Pair<Half>& b) {
  return {a.low / b.low, a.high / b.high};
}
template <class Half, typename Scalar>
SLIPWISE_LANES Pair<Half> operator+(const Pair<Half>& a, Scalar b) {
  return {a.low + b, a.high + b};
}
template <class Half, typename Scalar>
SLIPWISE_LANES Pair<Half> operator-(const Pair<Half>& a, Scalar b) {
  return {a.low - b, a.high - b};
}
template <class Half, typename Scalar>
SLIPWISE_LANES Pair<Half> operator*(const Pair<Half>& a, Scalar b) {
  return {a.low * b, a.high * b};
}

template <class Vector>
SLIPWISE_LANES Vector larger(const Vector& a, const Vector& b) {
  return a > b ? a : b;
}
template <class Half>
SLIPWISE_LANES Pair<Half> larger(const Pair<Half>& a, const Pair<Half>& b) {
  return {larger(a.low, b.low), larger(a.high, b.high)};
}

template <class Vector>
SLIPWISE_LANES Vector smaller(const Vector& a, const Vector& b) {
  return a < b ? a : b;
}
template <class Half>
SLIPWISE_LANES Pair<Half> smaller(const Pair<Half>& a, const Pair<Half>& b) {
  return {smaller(a.low, b.low), smaller(a.high, b.high)};
}

template <class Vector>
SLIPWISE_LANES Vector magnitude(const Vector& a) {
  return a < Vector{} ? -a : a;
}
template <class Half>
SLIPWISE_LANES Pair<Half> magnitude(const Pair<Half>& a) {
  return {magnitude(a.low), magnitude(a.high)};
}

/// 1, 0 or -1; `one` is 1 in every lane.
template <class Vector>
SLIPWISE_LANES Vector sign(const Vector& a, const Vector& one) {
  return a < Vector{} ? -one : (a > Vector{} ? one : Vector{});
}
template <class Half>
SLIPWISE_LANES Pair<Half> sign(const Pair<Half>& a, const Pair<Half>& one) {
  return {sign(a.low, one.low), sign(a.high, one.high)};
}

/// The root of each number.
template <typename Scalar, class Vector>
SLIPWISE_LANES Vector root_of(const Vector& squared) {
  constexpr std::size_t kLanes = sizeof(Vector) / sizeof(Scalar);
  alignas(64) Scalar numbers[kLanes];  // NOLINT(modernize-avoid-c-arrays)
  store(squared, numbers);
  for (Scalar& number : numbers) {
    if constexpr (std::is_same_v<Scalar, float>) {
      number = __builtin_sqrtf(number);
    } else {
      number = __builtin_sqrt(number);
    }
  }
  Vector root;
  load(numbers, root);
  return root;
}

/// Stores the first numbers of a block's lanes, which may be fewer than there are lanes.
template <typename Scalar, class Vector>
SLIPWISE_LANES void store_first(const Vector& value, std::size_t count, Scalar* to) {
  constexpr std::size_t kLanes = sizeof(Vector) / sizeof(Scalar);
  if (count == kLanes) {
    store(value, to);
    return;
  }
  alignas(64) Scalar numbers[kLanes];  // NOLINT(modernize-avoid-c-arrays)
  store(value, numbers);
  for (std::size_t i = 0; i < count; ++i) {
    to[i] = numbers[i];
  }
}

/// 1, and 0 where both are zero.
template <class Vector>
SLIPWISE_LANES Vector any_nonzero(const Vector& a, const Vector& b, const Vector& one) {
  return magnitude(a) + magnitude(b) > Vector{} ? one : Vector{};
}
template <class Half>
SLIPWISE_LANES Pair<Half> any_nonzero(const Pair<Half>& a, const Pair<Half>& b, const Pair<Half>& one) {
  return {any_nonzero(a.low, b.low, one.low), any_nonzero(a.high, b.high, one.high)};
}

}  // namespace slipwise
