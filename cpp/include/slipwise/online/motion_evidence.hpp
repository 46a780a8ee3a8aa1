// SPDX-License-Identifier: Apache-2.0
// What shows whether poses and inputs contradict each other, of all runs, in bounded memory.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "slipwise/online/gyro_buffer.hpp"
#include "slipwise/online/input_buffer.hpp"
#include "slipwise/online/motion_window.hpp"
#include "slipwise/online/pose_gate.hpp"
#include "slipwise/online/wheel_probe.hpp"

namespace slipwise {

/// Turns of a gyro against those of the inputs in a run, over seconds in which the inputs turn.
struct GyroTurns {
  std::size_t run = 0;
  std::size_t count = 0;  ///< seconds
  double product = 0.0;   ///< sum of turns by the inputs times turns by the gyro [rad^2]
  double square = 0.0;    ///< sum of the squares of turns by the inputs [rad^2]
};

/// Poses that the gate accepted, and those that it did not.
struct GateCounts {
  std::size_t accepted = 0;
  std::size_t outliers = 0;
  std::size_t jumps = 0;
};

/// What poses and inputs did in the last two minutes of driving, of turning for a gyro.
struct RecentEvidence {
  std::deque<MotionWindow> measured_windows;
  std::deque<MotionWindow> windows;
  std::vector<WheelProbe> probes;
  std::deque<GyroTurns> gyro_turns;
  GateCounts counts;
};

/// Takes what a stream uses, in the order of time: poses before and after the gate, inputs known until then, a gyro.
/// Of windows it keeps the last hundred minutes.
class MotionEvidence {
 public:
  /// Another run begins.
  void start_run();
  /// No measurement of this run follows.
  void end_run(const InputBuffer& wheels);
  /// Stamps are counted from `origin` [s] from now on.
  void count_from(double origin) { run_.origin = origin; }
  /// Something came, whether it is used or not.
  void see_stamp(double t);
  /// A pose as it was measured; inputs are known until its stamp.
  void see_measured(const MeasuredPose& pose, const InputBuffer& commands, const InputBuffer& wheels);
  /// What the gate made of poses, some of which may have waited.
  void see_gated(const GatedPoses& gated, const InputBuffer& commands, const InputBuffer& wheels);
  void push_gyro(const TimedNumber& sample) { yaw_rates_.push_back(sample); }
  /// Compares the turns of whole seconds before `t` [s], until which inputs are known.
  void compare_gyro(double t, const InputBuffer& commands, const InputBuffer& wheels);

  /// \throws std::invalid_argument when what was loaded cannot be.
  void check_loaded() const;

  /// Windows of poses as they were measured.
  const std::deque<MotionWindow>& measured_windows() const { return measured_.windows(); }
  /// Windows of poses that the gate accepted.
  const std::deque<MotionWindow>& windows() const { return accepted_.windows(); }
  const std::vector<WheelProbe>& probes() const { return probes_.probes(); }
  const std::deque<GyroTurns>& gyro_turns() const { return gyro_turns_; }
  const GateCounts& counts() const { return counts_; }
  /// What an hour of good driving hides; empty if the whole drive is recent.
  std::optional<RecentEvidence> recent() const;
  /// How much was compared so far: it grows while inputs drive the robot.
  std::size_t compared() const { return measured_.driven() + gyro_seconds_; }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.run_, self.run_begins_, self.measured_, self.accepted_, self.probes_, self.yaw_rates_, self.second_,
      self.gyro_turns_, self.last_seconds_, self.gyro_seconds_, self.counts_, self.counts_before_, self.gated_);
  }

 private:
  /// Adds the second that begins at `start`, in `inputs`.
  void compare_second(const InputBuffer& inputs, double start);
  double turn_until(double t) const;

  NumberedRun run_;
  bool run_begins_ = true;  ///< nothing of the run has come yet
  WindowCutter measured_;
  WindowCutter accepted_;
  ProbeCutter probes_;
  std::deque<TimedNumber> yaw_rates_;  ///< since the second that is compared next
  std::optional<double> second_;       ///< where that begins [s]
  std::deque<GyroTurns> gyro_turns_;
  std::deque<GyroTurns> last_seconds_;  ///< of turning, each alone
  std::size_t gyro_seconds_ = 0;        ///< of turning, ever
  GateCounts counts_;
  GateCounts counts_before_;      ///< the window that is measured now
  std::deque<GateCounts> gated_;  ///< in each of the recent windows
};

}  // namespace slipwise
