// SPDX-License-Identifier: Apache-2.0
// Where slip is now, kept from one prediction to the next.
#pragma once

#include <memory>
#include <vector>

#include "slipwise/estimate/coloured_slip.hpp"
#include "slipwise/online/held_out.hpp"
#include "slipwise/segment/driven_segment.hpp"

namespace slipwise {

/// Segments in the order of time, kept elsewhere.
using SegmentList = std::vector<const DrivenSegment*>;

/// Where slip is after some segments.
SlipNow slip_after(const ColouredSlip& disturbance, const MotionPosterior& motion, const SegmentList& segments);

/// What the last segments say of the slip now changes with a segment, not with a prediction: it is kept, so that a
/// prediction costs little more than its own path. Results are those of `slip_after`.
class RecentSlip {
 public:
  /// Whether `now` would find what it needs.
  bool has(const Knowledge& known, const SegmentList& learned) const;
  /// Where slip is after the `learned` segments, which are the last and do not change any more.
  const SlipNow& now(const Knowledge& known, const SegmentList& learned);

 private:
  /// Segments of one run are told apart by their ends.
  std::vector<double> ends_;
  std::shared_ptr<const MotionPosterior> motion_;
  SlipNow slip_;
};

}  // namespace slipwise
