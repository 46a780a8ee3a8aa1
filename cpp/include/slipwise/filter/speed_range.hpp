// SPDX-License-Identifier: Apache-2.0
// How fast the robot has gone so far: a causal quantile of speeds in constant memory.
#pragma once

#include <array>
#include <cstddef>

namespace slipwise {

/// Histogram of magnitudes over logarithmic bins from 1e-3 to 1e3, each 5 % wide, weighted by time.
class SpeedRange {
 public:
  /// Adds `seconds` at magnitude |value|; standstill does not count.
  void add(double value, double seconds);
  /// The magnitude below which `fraction` of the moving time lies; `floor` where nothing moved yet.
  double quantile(double fraction, double floor) const;
  /// A magnitude that no more than 1 - `fraction` of the moving time lies above; 0 where nothing moved yet.
  double upper(double fraction) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.seconds_, self.total_);
  }

 private:
  static constexpr std::size_t kBins = 284;  // ceil(ln(1e6) / ln(1.05))
  std::array<double, kBins> seconds_{};
  double total_ = 0.0;
};

}  // namespace slipwise
