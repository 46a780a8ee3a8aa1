// SPDX-License-Identifier: Apache-2.0
// How exact a pose is said to be beside those before it.
#pragma once

#include <cstddef>

#include "slipwise/segment/segment.hpp"

namespace slipwise {

/// Standard deviations that a measured pose comes with; zero where it comes without.
struct PoseStd {
  double xy = 0.0;   ///< per axis [m]
  double yaw = 0.0;  ///< [rad]
};

/// One of them beside the geometric mean of those of late. Only the ratio is used: how large errors are on the whole is
/// learned from residuals, since many programs state an unmeasured constant, or a sum that grows for ever.
class NominalStd {
 public:
  /// Ratio to those before; 1 where it is the first, or zero.
  double ratio(double std);

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.log_mean_, self.count_);
  }

 private:
  double log_mean_ = 0.0;
  std::size_t count_ = 0;
};

/// The same of poses, one after another.
class PoseAccuracy {
 public:
  PoseStdRatio ratio(const PoseStd& std) { return {.xy = xy_.ratio(std.xy), .yaw = yaw_.ratio(std.yaw)}; }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.xy_, self.yaw_);
  }

 private:
  NominalStd xy_;
  NominalStd yaw_;
};

}  // namespace slipwise
