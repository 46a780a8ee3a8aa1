// SPDX-License-Identifier: Apache-2.0
// What a learner does with segments of several sources of poses: those that are decided are learned next.
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>
#include <variant>
#include <vector>

#include "slipwise/online/motion_learner.hpp"

namespace slipwise {

/// By the present estimate of the slip: where the baseline predicts best, by the best model that has some.
void MotionLearner::learn_source() {
  auto item = std::get<SourceSegment>(std::move(waiting_.front()));
  waiting_.pop_front();
  const double start = item.driven.segment.start;
  KnownSources::Found found = sources_.see(*known_.back().slip, std::move(item));
  if (found.poor) {
    count({Stream::Pose, Reason::PoorPose, start});
  }
  waiting_.insert(waiting_.begin(), std::make_move_iterator(found.learned.begin()),
                  std::make_move_iterator(found.learned.end()));
}

/// At the end of a run no better source can come any more.
void MotionLearner::finish_sources() {
  if (settings_.stream.sources.empty()) {
    return;
  }
  for (DrivenSegment& segment : sources_.finish()) {
    segment.known_at = std::max(segment.known_at, stream_.newest());
    waiting_.emplace_back(std::move(segment));
  }
  work_through();
}

}  // namespace slipwise
