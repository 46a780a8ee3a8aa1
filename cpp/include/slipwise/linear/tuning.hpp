// SPDX-License-Identifier: Apache-2.0
// Tuning constants: ordinary ones, but for the build by which `benchmarks/sensitivity.py` varies them.
#pragma once

#ifndef SLIPWISE_SENSITIVITY

/// A chosen constant that changes the learned model.
#define SLIPWISE_TUNING(name, value) constexpr auto name = (value)  // NOLINT(bugprone-macro-parentheses): it is a name
/// Another that is made from such.
#define SLIPWISE_TUNED constexpr

#else

#include <cmath>
#include <concepts>
#include <cstdlib>
#include <string_view>

namespace slipwise {

/// The factor that the environment variable SLIPWISE_TUNING, "file.kName=2,...", has for a constant; otherwise 1.
inline double tuning_factor(std::string_view file, std::string_view name) {
  const char* given = std::getenv("SLIPWISE_TUNING");
  std::string_view factors = given == nullptr ? "" : given;
  file.remove_prefix(file.rfind('/') + 1);
  file = file.substr(0, file.find('.'));
  while (!factors.empty()) {
    const std::string_view entry = factors.substr(0, factors.find(','));
    factors.remove_prefix(entry.size() < factors.size() ? entry.size() + 1 : entry.size());
    const auto point = entry.find('.');
    const auto equal = entry.find('=');
    if (entry.substr(0, point) == file && entry.substr(point + 1, equal - point - 1) == name) {
      return std::strtod(entry.data() + equal + 1, nullptr);
    }
  }
  return 1.0;
}

/// The constant times its factor; one that counts is rounded, and at least 1.
template <typename Value>
Value tuned(std::string_view file, std::string_view name, Value value) {
  const double result = tuning_factor(file, name) * static_cast<double>(value);
  if constexpr (std::integral<Value>) {
    return static_cast<Value>(std::fmax(1.0, std::round(result)));
  } else {
    return result;
  }
}

}  // namespace slipwise

#define SLIPWISE_TUNING(name, value) const auto name = ::slipwise::tuned(__FILE__, #name, value)
#define SLIPWISE_TUNED const

#endif
