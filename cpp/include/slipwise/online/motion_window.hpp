// SPDX-License-Identifier: Apache-2.0
// Short windows in which what poses did is held against what the inputs said.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>

#include "slipwise/online/input_buffer.hpp"
#include "slipwise/online/pose_gate.hpp"

namespace slipwise {

/// Poses against inputs between two poses about 1.5 s apart.
struct MotionWindow {
  std::size_t run;      ///< in the order in which runs were started
  double start;         ///< [s] stamp of the first pose, as it was measured
  double since;         ///< [s] from the first pose of the run to that
  double duration;      ///< [s]
  double distance;      ///< between the first and the last pose [m]
  double course;        ///< direction of that line [rad]
  double turn;          ///< yaw of the last minus the first [rad], followed from pose to pose
  double turn_degrees;  ///< the same, were yaws in degrees
  double start_yaw;     ///< as measured
  double ahead;         ///< way along the measured heading [m], from pose to pose: curves do not shorten it
  double left;          ///< and across it
  HeldMotion commands;
  HeldMotion wheels;
};

/// Which run it is, and from where its stamps are counted.
struct NumberedRun {
  std::size_t number = 0;  ///< in the order in which runs were started
  double origin = 0.0;     ///< [s]
};

/// Cuts the poses of one frame after the other into windows, and keeps the last of those in which inputs are known, and
/// beside them the last two minutes of driving.
class WindowCutter {
 public:
  /// Another run begins.
  void start_run();
  /// Takes a pose; inputs are known until its stamp. A position heads along the path, turned about where the robot
  /// drives backward. Returns whether a window begins with it.
  bool push(const NumberedRun& run, const MeasuredPose& pose, const InputBuffer& commands, const InputBuffer& wheels);
  const std::deque<MotionWindow>& windows() const { return windows_; }
  /// The last two minutes of windows in which inputs drive the robot.
  const std::deque<MotionWindow>& recent() const { return recent_; }
  /// How many windows there ever were in which inputs drove the robot.
  std::size_t driven() const { return driven_; }
  /// \throws std::invalid_argument when what was loaded cannot be.
  void check_loaded() const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.windows_, self.recent_, self.driven_, self.run_began_, self.frame_began_, self.first_, self.last_,
      self.slot_, self.turn_, self.turn_degrees_, self.ahead_, self.left_, self.course_from_, self.course_);
  }

 private:
  struct Seen {
    double t;  ///< [s]
    double x;  ///< [m]
    double y;  ///< [m]
    double yaw;
    long frame;
  };
  void close(const NumberedRun& run, const Seen& last, const InputBuffer& commands, const InputBuffer& wheels);
  void add_way(const Seen& pose, double turned);
  void keep_recent(const MotionWindow& window);
  double course(const Seen& position, const InputBuffer& inputs);

  std::deque<MotionWindow> windows_;
  std::deque<MotionWindow> recent_;  ///< of driving
  std::size_t driven_ = 0;           ///< windows ever
  std::optional<double> run_began_;  ///< [s]
  double frame_began_ = 0.0;         ///< [s]
  std::optional<Seen> first_;        ///< pose of the window that is open
  std::optional<Seen> last_;         ///< pose
  double slot_ = 0.0;                ///< number of the window in its frame
  double turn_ = 0.0;                ///< since the first pose of the window [rad]
  double turn_degrees_ = 0.0;
  double ahead_ = 0.0;               ///< [m]
  double left_ = 0.0;                ///< [m]
  std::optional<Seen> course_from_;  ///< position from which the path heads to the next
  double course_ = 0.0;              ///< [rad]
};

/// An angle within half a turn on either side of 0.
double within_half_turn(double angle, double turn);

}  // namespace slipwise
