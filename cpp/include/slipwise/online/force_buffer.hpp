// SPDX-License-Identifier: Apache-2.0
// Known forces of late: on the whole over a segment, or as far as they are known when it begins.
#pragma once

#include <deque>
#include <optional>

namespace slipwise {

/// A known force over the robot's mass along its x axis and its y axis, from a stamp on.
struct KnownForce {
  double t;  ///< [s]
  double x;  ///< [m/s^2]
  double y;  ///< [m/s^2]
};

/// Forces in order of their stamps; each holds until the next one.
class ForceBuffer {
 public:
  void push(const KnownForce& force) { forces_.push_back(force); }
  /// The force at a stamp; empty before the first.
  std::optional<KnownForce> at(double t) const;
  /// The mean over [start, end], 0 before the first; empty where none was known by the end.
  std::optional<KnownForce> mean(double start, double end) const;
  void drop_before(double t);
  void clear() { forces_.clear(); }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.forces_);
  }

 private:
  std::deque<KnownForce> forces_;
};

}  // namespace slipwise
