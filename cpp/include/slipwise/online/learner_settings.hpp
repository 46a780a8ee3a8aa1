// SPDX-License-Identifier: Apache-2.0
// All that changes what a learner learns.
#pragma once

#include "slipwise/disturbance/slip_disturbance.hpp"
#include "slipwise/hypotheses/motion_hypotheses.hpp"
#include "slipwise/online/stream_settings.hpp"

namespace slipwise {

struct LearnerSettings {
  StreamSettings stream = {};
  HypothesisSettings hypotheses = {};
  DisturbanceSettings disturbance = {};
  bool learn_disturbance = true;  ///< how slip differs from what was learned, now and then
};

}  // namespace slipwise
