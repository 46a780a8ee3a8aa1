// SPDX-License-Identifier: Apache-2.0
// Pairs of poses a second apart with the path that the wheels make about them: odometry passed off as poses shows.
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "slipwise/lie/se2.hpp"
#include "slipwise/online/input_buffer.hpp"
#include "slipwise/online/pose_gate.hpp"

namespace slipwise {

/// A pose at its stamp.
struct StampedPose {
  double t;  ///< [s]
  double x;  ///< [m]
  double y;  ///< [m]
  double yaw;
};

/// Two poses, and the wheels' path from some time before the first to as much after the second.
struct WheelProbe {
  StampedPose first;
  StampedPose last;
  std::vector<StampedPose> path;  ///< begins at the origin
};

/// Keeps pairs in which the wheels turn, spread evenly over all that was driven.
class ProbeCutter {
 public:
  /// Another run begins.
  void start_run();
  /// No measurement of this run follows.
  void end_run(const InputBuffer& wheels);
  /// Takes a pose, to whose stamp `wheels` are known.
  void push(const MeasuredPose& pose, const InputBuffer& wheels);
  const std::vector<WheelProbe>& probes() const { return probes_; }
  /// \throws std::invalid_argument when what was loaded cannot be.
  void check_loaded() const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.open_, self.frame_, self.waiting_, self.probes_, self.every_, self.passed_);
  }

 private:
  void keep(WheelProbe probe, const InputBuffer& wheels);

  std::deque<StampedPose> open_;    ///< poses without a second one so far
  long frame_ = 0;                  ///< theirs
  std::deque<WheelProbe> waiting_;  ///< for the wheels after them
  std::vector<WheelProbe> probes_;
  std::size_t every_ = 1;   ///< pair is kept
  std::size_t passed_ = 0;  ///< pairs since the last that was kept
};

}  // namespace slipwise
