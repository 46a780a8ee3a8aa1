// SPDX-License-Identifier: Apache-2.0
// Numbers that carry their derivatives along: exact derivatives of what is written once, for doubles and for lanes.
#pragma once

#include <cmath>
#include <type_traits>
#include <utility>

#include "slipwise/linear/plain_value.hpp"

#define SLIPWISE_DUAL __attribute__((always_inline)) inline

// Plain arrays: the functions of std::array would be compiled for the processor of one file and called from others.
// NOLINTBEGIN(modernize-avoid-c-arrays)
namespace slipwise {

/// What a vector is made of.
template <class Number>
struct ElementOf {
  using Type = std::remove_cvref_t<decltype(std::declval<Number&>()[0])>;
};
template <>
struct ElementOf<double> {
  using Type = double;
};

/// A value and its derivatives by N variables (forward differentiation). `Number` is a double, or a vector of floats or
/// doubles; as one of these, a dual number holds nothing until it is given something.
template <class Number, int N>
struct Dual {
  using Constant = ElementOf<Number>::Type;
  Number value;
  Number by[N];

  SLIPWISE_DUAL Dual() = default;
  // NOLINTNEXTLINE(google-explicit-constructor, hicpp-explicit-conversions)
  SLIPWISE_DUAL Dual(const Number& constant) : value(constant), by{} {}
  /// The variable number `place`, whose derivative by what is asked for is `rate`.
  static SLIPWISE_DUAL Dual variable(const Number& v, int place, double rate = 1.0) {
    Dual dual(v);
    dual.by[place] = Number{} + static_cast<Constant>(rate);
    return dual;
  }
  /// A function of `a` alone with this value and this derivative by it.
  static SLIPWISE_DUAL Dual chained(const Number& value, const Number& by_a, const Dual& a) {
    Dual dual(value);
    for (int i = 0; i < N; ++i) {
      dual.by[i] = by_a * a.by[i];
    }
    return dual;
  }

  friend SLIPWISE_DUAL Dual operator+(const Dual& a, const Dual& b) {
    Dual sum(a.value + b.value);
    for (int i = 0; i < N; ++i) {
      sum.by[i] = a.by[i] + b.by[i];
    }
    return sum;
  }
  friend SLIPWISE_DUAL Dual operator-(const Dual& a, const Dual& b) {
    Dual difference(a.value - b.value);
    for (int i = 0; i < N; ++i) {
      difference.by[i] = a.by[i] - b.by[i];
    }
    return difference;
  }
  friend SLIPWISE_DUAL Dual operator*(const Dual& a, const Dual& b) {
    Dual product(a.value * b.value);
    for (int i = 0; i < N; ++i) {
      product.by[i] = a.by[i] * b.value + b.by[i] * a.value;
    }
    return product;
  }
  friend SLIPWISE_DUAL Dual operator/(const Dual& a, const Dual& b) {
    Dual quotient(a.value / b.value);
    for (int i = 0; i < N; ++i) {
      quotient.by[i] = (a.by[i] - quotient.value * b.by[i]) / b.value;
    }
    return quotient;
  }

  // With a constant, which has no derivatives.
  friend SLIPWISE_DUAL Dual operator-(const Dual& a) { return a * static_cast<Constant>(-1); }
  friend SLIPWISE_DUAL Dual operator+(Dual a, Constant b) {
    a.value = a.value + b;
    return a;
  }
  friend SLIPWISE_DUAL Dual operator-(Dual a, Constant b) {
    a.value = a.value - b;
    return a;
  }
  friend SLIPWISE_DUAL Dual operator+(Constant a, const Dual& b) { return b + a; }
  friend SLIPWISE_DUAL Dual operator-(Constant a, const Dual& b) { return -b + a; }
  friend SLIPWISE_DUAL Dual operator*(const Dual& a, Constant b) { return chained(a.value * b, Number{} + b, a); }
  friend SLIPWISE_DUAL Dual operator*(Constant a, const Dual& b) { return b * a; }
};

template <int N>
Dual<double, N> sqrt(const Dual<double, N>& a) {
  const double root = std::sqrt(a.value);
  return Dual<double, N>::chained(root, 1.0 / (2.0 * root), a);
}
template <int N>
Dual<double, N> cos(const Dual<double, N>& a) {
  return Dual<double, N>::chained(std::cos(a.value), -std::sin(a.value), a);
}
template <int N>
Dual<double, N> sin(const Dual<double, N>& a) {
  return Dual<double, N>::chained(std::sin(a.value), std::cos(a.value), a);
}
/// Where nothing is left of e^a, nothing is left of its derivative, however fast `a` moves.
template <int N>
Dual<double, N> expm1(const Dual<double, N>& a) {
  const double power = std::exp(a.value);
  return power == 0.0 ? Dual<double, N>(-1.0) : Dual<double, N>::chained(std::expm1(a.value), power, a);
}

/// The value alone.
template <class Number, int N>
double value_of(const Dual<Number, N>& a) {
  return a.value;
}

using Dual3 = Dual<double, 3>;

}  // namespace slipwise
// NOLINTEND(modernize-avoid-c-arrays)
