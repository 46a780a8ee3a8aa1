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
  Found found{.motion = motion, .ends = {}, .slip = disturbance.now(*motion, {})};
  for (const DrivenSegment* segment : segments) {
    disturbance.follow(*motion, found.slip, *segment);
    found.ends.push_back(end_of(segment));
  }
  found_.push_front(std::move(found));
  if (found_.size() > kKept) {
    found_.pop_back();
  }
  return found_.front().slip;
}

}  // namespace slipwise
