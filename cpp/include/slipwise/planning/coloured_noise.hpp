// SPDX-License-Identifier: Apache-2.0
// Smooth random sequences, many side by side: normal noise behind a first-order lag, always of unit variance.
#pragma once

#include <cstdint>
#include <vector>

namespace slipwise {

/// One sequence per lane. Values are sums of four uniform numbers: within 3.5 standard deviations, and nearly normal.
class ColouredNoise {
 public:
  /// `correlation` of a value with the one before it, 0 (white) to below 1. The same seed gives the same numbers.
  ColouredNoise(std::size_t lanes, float correlation, std::uint64_t seed);

  /// Forgets the last values: the next ones are as if the sequences began.
  void begin();
  /// The next value of every lane.
  const std::vector<float>& next();

 private:
  float keep_;
  float add_;
  bool begun_ = false;
  std::vector<std::uint32_t> state_;
  std::vector<float> value_;
};

}  // namespace slipwise
