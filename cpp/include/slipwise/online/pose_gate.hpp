// SPDX-License-Identifier: Apache-2.0
// Finds poses that jump further than the robot can have moved: lone ones are rejected, others begin a frame.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "slipwise/filter/speed_range.hpp"
#include "slipwise/online/input_buffer.hpp"
#include "slipwise/online/pose_accuracy.hpp"
#include "slipwise/online/pose_fix.hpp"
#include "slipwise/segment/segment.hpp"

namespace slipwise {

/// A measured pose of the pose sensor, and what tilts the robot then; or a measured position, whose yaw is that of the
/// inputs' way as it lies best on the positions of late.
struct MeasuredPose {
  double t;    ///< [s]
  double x;    ///< [m]
  double y;    ///< [m]
  double yaw;  ///< [rad]
  long frame = 0;
  double gx = 0.0;  ///< gravity along the body's x axis [m/s^2]
  double gy = 0.0;  ///< along its y axis [m/s^2]
  PoseStd std = {};
  PoseStdRatio std_ratio = {};
  std::size_t source = 0;  ///< of those that measure poses
  PoseFix fix = PoseFix::Unknown;
  bool position = false;  ///< whether only the position was measured
  bool learned = true;    ///< otherwise it says where the robot is, and no segment lies across it
};

/// What the gate makes of the poses.
struct GatedPoses {
  std::vector<MeasuredPose> accepted;  ///< in order, their frames numbered again where poses jump
  std::vector<MeasuredPose> outliers;  ///< lone poses far from their neighbours
  std::vector<MeasuredPose> jumps;     ///< the first pose after each jump that lasts
};

/// A pose out of reach of the last one waits for at most three more: if one of them is back near the last, those before
/// it were outliers; otherwise a new frame begins.
class PoseGate {
 public:
  /// Takes a pose; `inputs` are known until its stamp. Nothing that was measured later is used.
  GatedPoses push(const MeasuredPose& pose, const InputBuffer& inputs);
  /// No pose follows: what waits is decided.
  GatedPoses finish(const InputBuffer& inputs);
  /// Another run begins.
  void restart();

  /// \throws std::invalid_argument where a loaded one holds no pose of the frame that it is in.
  void check_loaded() const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.accepted_, self.waiting_, self.bends_, self.bend_count_, self.given_, self.frame_);
  }

 private:
  bool jumps(const MeasuredPose& from, const MeasuredPose& to, const InputBuffer& inputs) const;
  bool returns(const MeasuredPose& to) const;
  void accept(const MeasuredPose& pose, GatedPoses& out);
  void give_up(const InputBuffer& inputs, GatedPoses& out);
  void begin_frame(const MeasuredPose& pose, GatedPoses& out);
  void take(const MeasuredPose& pose, const InputBuffer& inputs, GatedPoses& out);
  void learn_noise(const MeasuredPose& pose);

  std::vector<MeasuredPose> accepted_;  ///< the last three of the frame
  std::vector<MeasuredPose> waiting_;   ///< out of reach of the last
  std::array<SpeedRange, 2> bends_;     ///< second differences of x and y [m]
  std::size_t bend_count_ = 0;
  std::optional<long> given_;  ///< frame of the last pose as it was given
  long frame_ = -1;
};

}  // namespace slipwise
