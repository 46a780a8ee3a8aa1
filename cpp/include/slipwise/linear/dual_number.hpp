// SPDX-License-Identifier: Apache-2.0
// Numbers that carry their derivatives by three variables along: exact derivatives of what is written once.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <utility>

#include "slipwise/linear/plain_value.hpp"

namespace slipwise {

/// A value and its derivatives by three variables (forward differentiation).
struct Dual3 {
  double value = 0.0;
  Eigen::RowVector3d by = Eigen::RowVector3d::Zero();

  Dual3() = default;
  Dual3(double constant) : value(constant) {}  // NOLINT(google-explicit-constructor, hicpp-explicit-conversions)
  Dual3(double v, Eigen::RowVector3d derivative) : value(v), by(std::move(derivative)) {}
  /// The variable number `place`.
  static Dual3 variable(double v, Eigen::Index place) { return {v, Eigen::RowVector3d::Unit(place)}; }
};

inline Dual3 operator+(const Dual3& a, const Dual3& b) { return {a.value + b.value, a.by + b.by}; }
inline Dual3 operator-(const Dual3& a, const Dual3& b) { return {a.value - b.value, a.by - b.by}; }
inline Dual3 operator-(const Dual3& a) { return {-a.value, -a.by}; }
inline Dual3 operator*(const Dual3& a, const Dual3& b) { return {a.value * b.value, a.by * b.value + b.by * a.value}; }
inline Dual3 operator/(const Dual3& a, const Dual3& b) {
  const double quotient = a.value / b.value;
  return {quotient, (a.by - quotient * b.by) / b.value};
}
inline Dual3 sqrt(const Dual3& a) {
  const double root = std::sqrt(a.value);
  return {root, a.by / (2.0 * root)};
}
inline Dual3 cos(const Dual3& a) { return {std::cos(a.value), -std::sin(a.value) * a.by}; }
inline Dual3 sin(const Dual3& a) { return {std::sin(a.value), std::cos(a.value) * a.by}; }

/// The value alone.
inline double value_of(const Dual3& a) { return a.value; }

}  // namespace slipwise
