// SPDX-License-Identifier: Apache-2.0
// What a measured attitude says of the robot: angles in one turn, and a sensor that is not mounted level put upright.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "slipwise/segment/ground.hpp"

namespace slipwise {

/// How the sensor of roll and pitch sits on the robot, as far as its attitudes tell.
struct AttitudeMounting {
  enum class Kind : std::uint8_t {
    Level,
    Rolled,  ///< by whole quarters of a turn about its forward axis, which is undone: its yaw is the robot's
    Other    ///< otherwise; what it says of tilt is not used
  };
  friend constexpr std::size_t enumerators(Kind /*type*/) { return 3; }
  Kind kind = Kind::Level;
  double roll = 0.0;   ///< on level ground [rad]: of a rolled sensor the quarters, of another the mean
  double pitch = 0.0;  ///< the same; 0 of a rolled sensor
};

/// No robot drives tilted by more than 45 degrees for half of the time: it is the sensor that is tilted on the robot.
class AttitudeGate {
 public:
  /// Roll in (-pi, pi] and pitch in [-pi/2, pi/2] of the robot; empty if no robot could drive like that, or the
  /// mounting is not known.
  std::optional<Tilt> level(const Tilt& measured);
  AttitudeMounting mounting() const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.seen_, self.steep_, self.cos_roll_, self.sin_roll_, self.pitch_);
  }

 private:
  double seen_ = 0.0;   ///< attitudes so far,
  double steep_ = 0.0;  ///< and those of them beyond 45 degrees, whose sums follow
  double cos_roll_ = 0.0;
  double sin_roll_ = 0.0;
  double pitch_ = 0.0;
};

}  // namespace slipwise
