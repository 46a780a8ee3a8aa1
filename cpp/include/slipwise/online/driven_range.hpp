// SPDX-License-Identifier: Apache-2.0
// What a robot did in all runs that a model is learned from: beyond it, the model is a guess.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/body_rates.hpp"
#include "slipwise/online/hold_times.hpp"
#include "slipwise/segment/ground.hpp"

namespace slipwise {

/// In constant memory, run after run.
class DrivenRange {
 public:
  /// `sensor` is where the pose sensor sits in base_link; inputs are unknown once they are older than `unknown_after`
  /// [s].
  DrivenRange(const Pose2& sensor, double unknown_after) : rates_(sensor), held_(unknown_after) {}

  /// An input that motion is predicted from; `given` is it before anything was made of it, as a car's throttle.
  void see(const InputSample& sample, const BodyTwist& given) {
    inputs_ = {std::min(inputs_[0], given.v), std::max(inputs_[1], given.v), std::min(inputs_[2], given.omega),
               std::max(inputs_[3], given.omega)};
    held_.push(sample);
  }
  /// A pose that is not late, its yaw unwrapped.
  void see(const MeasuredPose& pose) { rates_.push(pose); }
  void see(const Tilt& tilt) { steepest_ = std::max({steepest_, std::abs(tilt.roll), std::abs(tilt.pitch)}); }
  /// Another run begins.
  void restart() {
    rates_.restart();
    held_.restart();
  }

  /// Least and greatest speed, then yaw rate, of the inputs.
  const std::array<double, 4>& inputs() const { return inputs_; }
  /// Of the body, by the poses.
  MeasuredRates rates() const { return rates_.found(); }
  /// For how long inputs were held: speed, yaw rate [s].
  std::array<double, 2> held() const { return held_.found(); }
  /// Greatest roll or pitch [rad].
  double steepest() const { return steepest_; }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.inputs_, self.rates_, self.held_, self.steepest_);
  }

 private:
  std::array<double, 4> inputs_{kNever, -kNever, kNever, -kNever};
  BodyRates rates_;
  HoldTimes held_;
  double steepest_ = 0.0;
};

}  // namespace slipwise
