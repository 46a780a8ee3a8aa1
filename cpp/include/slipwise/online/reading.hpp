// SPDX-License-Identifier: Apache-2.0
// A number that a sensor measures again and again beside poses, and what a kind of such sensors is called.
#pragma once

#include <cstddef>
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

}  // namespace slipwise
