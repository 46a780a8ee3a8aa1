// SPDX-License-Identifier: Apache-2.0
// Measured attitudes of late, and the ground that they tell of: along a segment, or from its start on.
#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "slipwise/segment/body_gravity.hpp"
#include "slipwise/segment/ground.hpp"

namespace slipwise {

/// Roll and pitch in order of their stamps; of those closer together than 20 ms, the first.
class TiltBuffer {
 public:
  void push(const Tilt& tilt);
  /// The last at a stamp or before it, no older than `oldest` [s].
  std::optional<Tilt> known_at(double t, double oldest) const;
  /// The measurements over [start, end], with one before and one after; empty if none is known at the start.
  std::shared_ptr<const Ground> along(double start, double end, double oldest) const;
  /// The plane that the robot stands on at a stamp, as far as is known then; nothing measured later is used.
  std::shared_ptr<const Ground> from(double start, double oldest) const;
  void drop_before(double t);
  void clear() { tilts_.clear(); }
  bool empty() const { return tilts_.empty(); }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.tilts_);
  }

 private:
  std::deque<Tilt> tilts_;
};

/// Gravity along the robot's x axis and its y axis [m/s^2].
BodyGravity gravity_of(const Tilt& tilt);

}  // namespace slipwise
