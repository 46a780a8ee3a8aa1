// SPDX-License-Identifier: Apache-2.0
// A number that a sensor measures again and again beside poses, and what a kind of such sensors is called.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string_view>

namespace slipwise {

/// A kind of sensor that measures one number, as logs and people name it.
struct ReadingKind {
  std::string_view column;   ///< of a tidy log
  std::string_view sensor;   ///< in a word
  std::string_view unit;     ///< of the number
  std::string_view meaning;  ///< of the number
};

/// A number that one measured.
struct Reading {
  std::size_t kind = 0;  ///< among `kReadings`
  double t = 0.0;        ///< [s]
  double value = 0.0;
};

/// A number at its stamp.
struct TimedNumber {
  double t;  ///< [s]
  double value;
};
/// The integral over [start, end] [s] of numbers in the order of their stamps, which change along lines in between;
/// empty where some are missing.
std::optional<double> integral(const std::deque<TimedNumber>& numbers, double start, double end);
/// Drops what no integral from `t` [s] on needs.
void drop_before(std::deque<TimedNumber>& numbers, double t);

}  // namespace slipwise
