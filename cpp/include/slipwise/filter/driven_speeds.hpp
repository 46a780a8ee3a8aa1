// SPDX-License-Identifier: Apache-2.0
// The speeds that the robot was driven at so far, as references of the priors.
#pragma once

#include "slipwise/actuator/input_history.hpp"
#include "slipwise/filter/prior.hpp"
#include "slipwise/filter/speed_range.hpp"
#include "slipwise/segment/segment.hpp"

namespace slipwise {

class DrivenSpeeds {
 public:
  /// Adds the inputs of one segment.
  void see(const InputHistory& inputs, const Segment& segment);
  /// Begins with what was driven before, at speeds about these for so many `seconds`.
  void begin_with(const ReferenceSpeeds& speeds, double seconds);
  /// The 90th percentiles so far, at least 0.05.
  ReferenceSpeeds reference() const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.speeds_, self.yaw_rates_);
  }

 private:
  SpeedRange speeds_;
  SpeedRange yaw_rates_;
};

}  // namespace slipwise
