// SPDX-License-Identifier: Apache-2.0
// Gives positions a heading: that with which the way that the inputs made of late lies best on them.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "slipwise/lie/se2.hpp"
#include "slipwise/online/input_buffer.hpp"
#include "slipwise/online/pose_gate.hpp"

namespace slipwise {

/// Takes the positions of one run after another. Nothing that was measured later is used.
class CourseFinder {
 public:
  CourseFinder() = default;
  /// `sensor` is where the antenna is known to sit in base_link.
  explicit CourseFinder(const Pose2& sensor) : sensor_(sensor) {}

  /// The heading at a position [rad], unwrapped along its frame; `inputs` are known until its stamp. Empty where the
  /// robot hardly moved of late, or not as the inputs say.
  std::optional<double> push(const MeasuredPose& position, const InputBuffer& inputs);

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.sensor_, self.passed_, self.frame_, self.last_yaw_);
  }

 private:
  /// A position, and where the robot was by its inputs.
  struct Passed {
    double t;  ///< [s]
    Eigen::Vector2d measured;
    Pose2 reckoned;
  };

  Pose2 sensor_;
  std::deque<Passed> passed_;  ///< of late
  long frame_ = 0;
  std::optional<double> last_yaw_;  ///< of the frame [rad]
};

}  // namespace slipwise
