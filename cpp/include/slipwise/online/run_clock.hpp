// SPDX-License-Identifier: Apache-2.0
// Stamps counted from where measurements begin, so that the hour of the day costs no digits.
#pragma once

#include <cmath>

namespace slipwise {

/// Counts from the multiple of 2^16 s (18 h) next to the first stamp towards 0: later measurements are counted, and
/// handed back, exactly, and streams that arrive in another order are counted from the same.
class RunClock {
 public:
  /// The first stamp [s].
  void start_at(double stamp) { origin_ = kStep * std::trunc(stamp / kStep); }
  double counted(double stamp) const { return stamp - origin_; }
  double stamp(double counted) const { return origin_ + counted; }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.origin_);
  }

 private:
  static constexpr double kStep = 65536.0;  // [s]
  double origin_ = 0.0;
};

}  // namespace slipwise
