// SPDX-License-Identifier: Apache-2.0
// Where slip was of late, kept from one prediction to the next.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "slipwise/disturbance/slip_disturbance.hpp"
#include "slipwise/segment/driven_segment.hpp"

namespace slipwise {

/// Segments in the order of time, kept elsewhere.
using SegmentList = std::vector<const DrivenSegment*>;

/// What the last segments say of the slip now changes with a segment or with the estimate, not with a prediction: what
/// was found of late is kept, so that a prediction costs little more than its own path.
class RecentSlip {
 public:
  /// Where slip is after `segments`, the last of a run, under the estimated motion: good until the next call.
  const SlipNow& after(const DisturbanceFilter& disturbance, const std::shared_ptr<const MotionPosterior>& motion,
                       const SegmentList& segments);
  /// Another run begins: segments of one run are distinguished by their ends.
  void restart() { found_.clear(); }

 private:
  struct Found {
    std::shared_ptr<const MotionPosterior> motion;
    std::vector<double> ends;                               ///< of the segments [s]
    std::vector<std::shared_ptr<const ObservedSlip>> seen;  ///< of each of them
    SlipNow slip;
  };

  /// What a segment shows under the motion, as it was found for other segments beside it.
  std::shared_ptr<const ObservedSlip> seen(const std::shared_ptr<const MotionPosterior>& motion,
                                           const DrivenSegment& segment) const;

  std::deque<Found> found_;  ///< the last one that was asked for comes first
};

}  // namespace slipwise
