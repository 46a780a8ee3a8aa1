// SPDX-License-Identifier: Apache-2.0
// What a learner has to say: events that wait for a call, and what was rejected; each with its run and its stamp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "slipwise/hypotheses/motion_hypotheses.hpp"
#include "slipwise/online/held_out.hpp"
#include "slipwise/online/rejection.hpp"
#include "slipwise/online/run_clock.hpp"
#include "slipwise/online/stream_output.hpp"

namespace slipwise {

/// Which fields are meant depends on the kind.
struct LearnerEvent {
  enum class Kind : std::uint8_t { SegmentLearned, Rejected, TerrainChange, HeldOut, Refit };
  friend constexpr std::size_t enumerators(Kind /*type*/) { return 5; }
  Kind kind;
  double t;             ///< [s]
  std::size_t run = 0;  ///< in the order in which runs were started
  Stream stream = Stream::Pose;
  Reason reason = Reason::NotFinite;
  std::array<StructureUpdate, kStructures> updates = {};
  std::array<double, kStructures> weights = {};
  /// What each structure knows after the segment; empty if it is not tried.
  std::array<std::shared_ptr<const MotionPosterior>, kStructures> posteriors = {};
  std::shared_ptr<const HeldOutPrediction> prediction = {};
  /// After a segment that was learned, where surfaces are remembered: how probable each is.
  std::vector<SurfaceProbability> surfaces = {};
};

/// Something that happened to the surfaces, and when.
struct DatedSurfaceEvent {
  SurfaceEvent event;
  std::size_t run;  ///< in the order in which runs were started
  double t;         ///< [s] end of the last segment that spoke, or of the run before a drive
};

/// Stamps are given as they are counted (`RunClock`), and kept as they were measured. The oldest events are dropped
/// where they wait for long.
class LearnerLog {
 public:
  /// By which stamps are counted.
  RunClock& clock() { return clock_; }
  const RunClock& clock() const { return clock_; }
  /// The present run, in the order in which runs were started.
  std::size_t run() const { return run_; }
  void next_run() { ++run_; }

  /// Something of the present run.
  void say(LearnerEvent event);
  /// Of the surfaces, at `t` [s] of any run.
  void say(std::vector<SurfaceEvent> events, std::size_t run, double t);
  /// Counts and says what was rejected.
  void reject(const Rejected& rejected);

  std::vector<LearnerEvent> take_events();
  std::vector<DatedSurfaceEvent> take_surface_events();
  std::size_t dropped() const { return dropped_; }
  const RejectionCounts& rejected() const { return rejected_; }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.clock_, self.run_, self.events_, self.dropped_, self.rejected_, self.surface_events_);
  }

 private:
  RunClock clock_;
  std::size_t run_ = 0;
  std::deque<LearnerEvent> events_;
  std::size_t dropped_ = 0;
  RejectionCounts rejected_{};
  std::deque<DatedSurfaceEvent> surface_events_;
};

}  // namespace slipwise
