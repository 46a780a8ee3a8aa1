// SPDX-License-Identifier: Apache-2.0
// What was found for a posterior and some segments holds until either changes.
#include "slipwise/online/recent_slip.hpp"

#include <algorithm>
#include <iterator>

namespace slipwise {
namespace {

double end_of(const DrivenSegment* segment) { return segment->segment.end; }

}  // namespace

SlipNow slip_after(const ColouredSlip& disturbance, const MotionPosterior& motion, const SegmentList& segments) {
  SlipNow slip = disturbance.now(motion, {});
  for (const DrivenSegment* segment : segments) {
    disturbance.follow(motion, slip, *segment);
  }
  return slip;
}

bool RecentSlip::has(const Knowledge& known, const SegmentList& learned) const {
  return motion_ == known.motion && std::ranges::equal(ends_, learned, {}, {}, end_of);
}

const SlipNow& RecentSlip::now(const Knowledge& known, const SegmentList& learned) {
  if (!has(known, learned)) {
    slip_ = slip_after(*known.disturbance, *known.motion, learned);
    motion_ = known.motion;
    ends_.clear();
    std::ranges::transform(learned, std::back_inserter(ends_), end_of);
  }
  return slip_;
}

}  // namespace slipwise
