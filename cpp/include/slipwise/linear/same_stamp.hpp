// SPDX-License-Identifier: Apache-2.0
// When stamps are the same: no decision may hang on the last bit of a time of day.
#pragma once

#include <cmath>
#include <limits>

namespace slipwise {

/// [s] Stamps no further apart are the same. A stamp of this century, counted from 1970, is rounded to 2.4e-7 s, and
/// what is reckoned from such stamps errs by a few times that. Clocks count microseconds: no whole number of them is
/// near.
inline constexpr double kSameStamp = 1.5e-6;

/// [s] A stamp later than any, and its negative earlier than any.
inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// Whether stamp `a` [s] is later than `b`, by more than rounding.
constexpr bool later(double a, double b) { return a > b + kSameStamp; }

/// Whether both stamps [s] are one but for rounding.
inline bool same_stamp(double a, double b) { return std::abs(a - b) <= kSameStamp; }

}  // namespace slipwise
