// SPDX-License-Identifier: Apache-2.0
// Knowledge by its stamps.
#include "slipwise/online/recent_knowledge.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "slipwise/archive/bytes.hpp"
#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {

RecentKnowledge::RecentKnowledge(Knowledge first, bool disturbed, double recent, double longest)
    : disturbed_(disturbed), recent_(recent), longest_(longest) {
  known_.push_back(std::move(first));
}

void RecentKnowledge::publish(Knowledge known, const DrivenSegment& segment) {
  known_.push_back(std::move(known));
  while (known_.size() > 2 && known_[1].until < segment.known_at - longest_) {
    known_.pop_front();
  }
  segments_.push_back(segment);
  while (segments_.front().segment.start < segment.segment.end - 2.0 * longest_) {
    segments_.pop_front();
  }
}

void RecentKnowledge::start_run() {
  segments_.clear();
  slip_.restart();
}

void RecentKnowledge::restart_clock() {
  for (Knowledge& known : known_) {
    known.until = -std::numeric_limits<double>::infinity();
  }
  known_.erase(known_.begin(), known_.end() - 1);
}

const Knowledge& RecentKnowledge::at(double t) const {
  for (std::size_t i = known_.size() - 1; i > 0; --i) {
    if (!later(known_[i].until, t)) {
      return known_[i];
    }
  }
  return known_.front();
}

SegmentList RecentKnowledge::segments_before(double t) const {
  SegmentList found = segments_until(t);
  std::erase_if(found, [&](const DrivenSegment* segment) { return later(segment->known_at, t); });
  return found;
}

SegmentList RecentKnowledge::segments_until(double t) const {
  SegmentList found;
  if (!disturbed_) {
    return found;
  }
  for (const DrivenSegment& segment : segments_) {
    if (!later(segment.segment.end, t) && later(segment.segment.start, t - recent_)) {
      found.push_back(&segment);
    }
  }
  return found;
}

void RecentKnowledge::check_loaded(const RecentKnowledge& made) const {
  const auto complete = [](const Knowledge& known) { return known.motion && known.slip && known.disturbance; };
  archive::require(!known_.empty() && std::ranges::all_of(known_, complete) && disturbed_ == made.disturbed_ &&
                       recent_ == made.recent_ && longest_ == made.longest_,
                   "what was known of late is not of its learner");
}

}  // namespace slipwise
