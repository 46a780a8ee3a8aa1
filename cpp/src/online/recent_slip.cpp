// SPDX-License-Identifier: Apache-2.0
// What was found for a posterior and some segments holds until either changes.
#include "slipwise/online/recent_slip.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

namespace slipwise {
namespace {

constexpr std::size_t kKept = 8;  // of several horizons, of the prediction to come, and of the next segment to learn

}  // namespace

const SlipNow& RecentSlip::after(const DisturbanceFilter& disturbance,
                                 const std::shared_ptr<const MotionPosterior>& motion, const SegmentList& segments) {
  const auto end_of = [](const DrivenSegment* segment) { return segment->segment.end; };
  const auto place = std::ranges::find_if(found_, [&](const Found& each) {
    return each.motion == motion && std::ranges::equal(each.ends, segments, {}, {}, end_of);
  });
  if (place != found_.end()) {
    std::rotate(found_.begin(), place, std::next(place));
    return found_.front().slip;
  }
  Found found{.motion = motion, .ends = {}, .seen = {}, .slip = disturbance.now(*motion, {})};
  if (!found.slip.of_candidates.empty()) {
    std::ranges::transform(segments, std::back_inserter(found.seen),
                           [&](const DrivenSegment* segment) { return seen(motion, *segment); });
  }
  for (const auto& each : found.seen) {
    DisturbanceFilter::follow(found.slip, *each);
  }
  std::ranges::transform(segments, std::back_inserter(found.ends), end_of);
  found_.push_front(std::move(found));
  if (found_.size() > kKept) {
    found_.pop_back();
  }
  return found_.front().slip;
}

std::shared_ptr<const ObservedSlip> RecentSlip::seen(const std::shared_ptr<const MotionPosterior>& motion,
                                                     const DrivenSegment& segment) const {
  for (const Found& each : found_) {
    const auto place = std::ranges::find(each.ends, segment.segment.end);
    if (each.motion == motion && place != each.ends.end()) {
      return each.seen[static_cast<std::size_t>(place - each.ends.begin())];
    }
  }
  return std::make_shared<const ObservedSlip>(DisturbanceFilter::see(*motion, segment));
}

}  // namespace slipwise
