// SPDX-License-Identifier: Apache-2.0
// Pairs of poses a second apart with the path that the wheels make about them: odometry passed off as poses shows.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
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

/// Keeps pairs in which the wheels turn, spread evenly over all that was driven, and beside them the last ones.
class ProbeCutter {
 public:
  /// Another run begins.
  void start_run();
  /// No measurement of this run follows.
  void end_run(const InputBuffer& wheels);
  /// Takes a pose, to whose stamp `wheels` are known.
  void push(const MeasuredPose& pose, const InputBuffer& wheels);
  const std::vector<WheelProbe>& probes() const { return probes_; }
  /// Of the last two minutes of driving.
  const std::vector<WheelProbe>& recent() const { return recent_; }
  /// \throws std::invalid_argument when what was loaded cannot be.
  void check_loaded() const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.open_, self.frame_, self.waiting_, self.probes_, self.every_, self.passed_, self.recent_,
      self.recent_until_);
  }

 private:
  struct Waiting {
    WheelProbe probe;
    bool spread;  ///< whether it is one of those over all that was driven
    bool recent;  ///< whether it is one of the last
  };
  void keep(Waiting waiting, const InputBuffer& wheels);

  std::deque<StampedPose> open_;  ///< poses without a second one so far
  long frame_ = 0;                ///< theirs
  std::deque<Waiting> waiting_;   ///< for the wheels after them
  std::vector<WheelProbe> probes_;
  std::size_t every_ = 1;   ///< pair is kept
  std::size_t passed_ = 0;  ///< pairs since the last that was kept
  std::vector<WheelProbe> recent_;
  std::optional<double> recent_until_;  ///< [s] no pair that begins before is another recent one
};

}  // namespace slipwise
