// SPDX-License-Identifier: Apache-2.0
// A prediction from what was known before, held against what was measured.
#pragma once

#include <memory>

#include "slipwise/online/held_out.hpp"
#include "slipwise/online/learner_log.hpp"
#include "slipwise/online/learner_settings.hpp"
#include "slipwise/online/recent_knowledge.hpp"
#include "slipwise/online/stream_output.hpp"

namespace slipwise {

/// What was known, where a force was, with the force as it is expected amid a segment.
std::shared_ptr<const MotionPosterior> motion_amid(const Knowledge& known, const Segment& segment,
                                                   const LearnerSettings& settings);

/// Predicts a target from what was `recent` before it; the `errors` learn how far that lies from what was measured.
HeldOutPrediction judged(const TargetSegment& target, const LearnerSettings& settings, RecentKnowledge& recent,
                         HeldOutErrors& errors, const LearnerLog& log);

}  // namespace slipwise
