// SPDX-License-Identifier: Apache-2.0
// What is driven on a surface from when the robot comes to it until it leaves it.
#pragma once

#include <cstddef>
#include <string>

#include "slipwise/filter/driven_speeds.hpp"
#include "slipwise/hypotheses/surface.hpp"

namespace slipwise {

/// How much was driven, and how fast.
struct Driven {
  double seconds = 0.0;
  std::size_t segments = 0;
  DrivenSpeeds speeds = {};
};

/// A trial that goes on will say on which surface its segments were driven.
class SurfaceVisit {
 public:
  void start_drive(const std::string& date) { date_ = date; }
  void see(const InputHistory& inputs, const Segment& segment, bool in_trial);
  /// Segments on the present surface since it was taken.
  std::size_t segments() const { return here_.segments; }
  /// The trial's segments were driven on the present surface,
  void stay();
  /// or on another one, which is the present one from now on.
  void come_to_another();
  /// Counts with the surface what was driven on it.
  void leave(Surface& surface);

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.here_, self.in_trial_, self.date_);
  }

 private:
  Driven here_;      ///< on the present surface since it was taken
  Driven in_trial_;  ///< since the trial began
  std::string date_;
};

}  // namespace slipwise
