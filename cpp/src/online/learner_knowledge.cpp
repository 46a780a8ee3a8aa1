// SPDX-License-Identifier: Apache-2.0
// What a learner knew at a time: nothing measured later is in it.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "slipwise/filter/body_force.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/learner_times.hpp"
#include "slipwise/online/motion_learner.hpp"

namespace slipwise {
Knowledge MotionLearner::now_known(double until) const {
  const auto motion = hypotheses_.posterior();
  return {
      .until = until,
      .motion = motion,
      .slip = motion->structure == Structure::Baseline ? hypotheses_.slip_posterior() : motion,
      .disturbance = std::make_shared<const DisturbanceFilter>(disturbance_),
      .sources = settings_.stream.sources.empty() ? nullptr : std::make_shared<const SourceNoise>(sources_.noise())};
}

/// The newest of what was known at `t` [s].
const Knowledge& MotionLearner::known_at(double t) const {
  for (std::size_t i = known_.size() - 1; i > 0; --i) {
    if (!later(known_[i].until, t)) {
      return known_[i];
    }
  }
  return known_.front();
}

/// What was known, where a force was, with the force as it is expected amid a segment.
std::shared_ptr<const MotionPosterior> MotionLearner::aged(const Knowledge& known, const Segment& segment) const {
  const BodyForce force(known.motion->model.basis(), settings_.hypotheses.filter.force);
  if (!force.learned() || !std::isfinite(known.until)) {
    return known.motion;
  }
  MotionPosterior later = *known.motion;
  const double amid = 0.5 * (segment.start + segment.end);
  const double spoken = known.until - 0.5 * settings_.stream.segment_length;  // the middle of the last segment
  force.pass(later.estimate, std::max(amid - spoken, 0.0));
  return std::make_shared<const MotionPosterior>(std::move(later));
}

/// The last segments that were complete at `t` [s].
SegmentList MotionLearner::recent_before(double t) const {
  SegmentList found;
  if (!settings_.learn_disturbance) {
    return found;
  }
  const double since = t - kRecent * settings_.stream.segment_length;
  for (const DrivenSegment& segment : recent_) {
    if (!later(segment.known_at, t) && later(segment.segment.start, since)) {
      found.push_back(&segment);
    }
  }
  return found;
}

}  // namespace slipwise
