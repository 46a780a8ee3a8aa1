// SPDX-License-Identifier: Apache-2.0
// The last of what was driven, in which limits of an actuator are looked for.
#pragma once

#include <deque>
#include <optional>

#include "slipwise/hypotheses/structures.hpp"
#include "slipwise/online/actuator_limits.hpp"

namespace slipwise {

class LimitEvidence {
 public:
  /// Commands and the wheel speeds that followed them.
  void keep_wheels(WheelSegment segment);
  /// The same of twists between poses.
  void keep_twists(WheelSegment segment);
  /// By which limits are judged.
  void keep(const DrivenSegment& segment);
  /// Limits behind which what was kept is predicted better, where there is enough of it.
  std::optional<ActuatorLimits> find(const Structures& learned, const MotionPosterior& kept,
                                     const HypothesisSettings& settings, double wheel_separation) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.wheels_, self.twists_, self.commands_);
  }

 private:
  std::deque<WheelSegment> wheels_;
  std::deque<WheelSegment> twists_;
  std::deque<DrivenSegment> commands_;
};

}  // namespace slipwise
