// SPDX-License-Identifier: Apache-2.0
// Gives positions a heading: the course of the chord from an earlier one, as far as the inputs tell what lies between.
#pragma once

#include <deque>
#include <optional>

#include "slipwise/lie/se2.hpp"
#include "slipwise/online/input_buffer.hpp"
#include "slipwise/online/pose_gate.hpp"

namespace slipwise {

/// Takes the positions of one run after another. Nothing that was measured later is used.
class ChordFinder {
 public:
  ChordFinder() = default;
  /// `sensor` is where the antenna is known to sit in base_link.
  explicit ChordFinder(const Pose2& sensor) : sensor_(sensor) {}

  /// The position with the headings of two chords, one position apart, the shorter in use; `inputs` are known until its
  /// stamp. Empty if the robot came no chord's length along, or the inputs do not say how.
  std::optional<MeasuredPose> push(const MeasuredPose& position, const InputBuffer& inputs);

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.sensor_, self.positions_, self.last_yaw_);
  }

 private:
  std::optional<ChordHeading> along(const MeasuredPose& from, const MeasuredPose& to, const InputBuffer& inputs) const;

  Pose2 sensor_;
  std::deque<MeasuredPose> positions_;  ///< of the frame, of late
  std::optional<double> last_yaw_;      ///< of the frame [rad]
};

}  // namespace slipwise
