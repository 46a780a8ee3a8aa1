// SPDX-License-Identifier: Apache-2.0
// What was known of late, by the stamps of what it was learned from: predictions use nothing that came later.
#pragma once

#include <deque>
#include <memory>
#include <utility>

#include "slipwise/online/held_out.hpp"
#include "slipwise/online/recent_slip.hpp"

namespace slipwise {

/// The knowledge after each of the last segments, and these segments.
class RecentKnowledge {
 public:
  RecentKnowledge() = default;
  /// Segments tell of the slip now for `recent` [s]; nothing is asked that lies more than `longest` [s] back. Without
  /// a slip disturbance, segments tell nothing.
  RecentKnowledge(Knowledge first, bool disturbed, double recent, double longest);

  /// After a segment.
  void publish(Knowledge known, const DrivenSegment& segment);
  /// What is known now is something else, of the same measurements.
  void replace(Knowledge known) { known_.back() = std::move(known); }
  /// Another run begins: its segments alone tell of the slip.
  void start_run();
  /// Stamps begin again: what is known now was known before all of them.
  void restart_clock();

  const Knowledge& newest() const { return known_.back(); }
  /// The newest of what was known at `t` [s].
  const Knowledge& at(double t) const;
  /// The last segments that were complete at `t` [s].
  SegmentList segments_before(double t) const;
  /// The last segments that had ended at `t` [s], however late they were known.
  SegmentList segments_until(double t) const;
  /// Where slip was after these of them: good until the next call.
  const SlipNow& slip_after(const DisturbanceFilter& disturbance, const std::shared_ptr<const MotionPosterior>& motion,
                            const SegmentList& segments) {
    return slip_.after(disturbance, motion, segments);
  }

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const RecentKnowledge& made) const;

  /// Names what is saved. Where slip is now is found again from the rest.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.known_, self.segments_, self.disturbed_, self.recent_, self.longest_);
  }

 private:
  std::deque<Knowledge> known_;         ///< the last is the newest
  std::deque<DrivenSegment> segments_;  ///< of the run
  bool disturbed_ = false;
  double recent_ = 0.0;
  double longest_ = 0.0;
  RecentSlip slip_;  ///< found again from the rest where it is loaded
};

}  // namespace slipwise
