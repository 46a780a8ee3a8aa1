// SPDX-License-Identifier: Apache-2.0
// One segment after the other through all structures, whichever predicts better, and the surfaces that they share.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "slipwise/hypotheses/known_before.hpp"
#include "slipwise/hypotheses/structures.hpp"
#include "slipwise/hypotheses/surface_bank.hpp"
#include "slipwise/segment/driven_segment.hpp"

namespace slipwise {

/// How one structure took a segment in.
struct StructureUpdate {
  double nis = 0.0;     ///< of the segment before it was learned
  double weight = 1.0;  ///< how much it counted: 0 rejected
  SlipChange change = {};
  bool refitted = false;  ///< whether a refit of its filters took effect
};

/// Runs all structures causally, piece by piece.
class MotionHypotheses {
 public:
  explicit MotionHypotheses(const HypothesisSettings& settings);

  /// Begins to learn one segment. `wheels_known` says whether wheel speeds came beside the commands so far.
  void start(const DrivenSegment& segment, bool wheels_known);
  /// Does a bounded piece of it; whether there is more to do.
  bool advance();
  /// Another drive begins: on a surface that is remembered, or a new one. `law` is the slip disturbance as it is known.
  void start_drive(const DisturbanceModel& law, const DriveStart& start);
  /// Segments of one run are not joined with those of another.
  void start_run();
  /// Begins with what another learner knew, before anything is learned. `wheels_known` says whether wheel speeds come
  /// beside the commands.
  /// \throws std::invalid_argument when something was learned already, or the terms are not those that are learned.
  void begin_with(const KnownBefore& known, double segment_length, bool wheels_known);
  /// Takes in what another learner of the same robot remembers (`SurfaceBank::add`).
  std::vector<std::string> add_surfaces(const DisturbanceModel& law, const KnownBefore& other);

  Structures& structures() { return structures_; }
  const Structures& structures() const { return structures_; }
  /// The surfaces that the structures share.
  SurfaceBank& bank() { return bank_; }
  const SurfaceBank& bank() const { return bank_; }
  /// How each structure took the last segment in.
  const std::array<StructureUpdate, kStructures>& updates() const { return updates_; }
  /// Segments learned.
  std::size_t count() const { return count_; }

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const MotionHypotheses& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.structures_);
    a(self.updates_, self.count_, self.segment_, self.to_predict_, self.predicted_, self.averaging_);
    a(self.bank_, self.begun_with_);
  }

 private:
  void join_cascade(bool wheels_known);
  void restart_cascade();
  ScoredSegment learned(const ModelAverage& average, Structure structure);
  void end_segment();

  Structures structures_;
  std::array<StructureUpdate, kStructures> updates_{};
  std::size_t count_ = 0;
  std::optional<DrivenSegment> segment_;  ///< that is being learned
  std::vector<Structure> to_predict_;     ///< it, in this order
  std::vector<ScoredSegment> predicted_;  ///< so far
  bool averaging_ = false;                ///< an average is learning it
  SurfaceBank bank_;
  std::optional<Structure> begun_with_;  ///< which was the best before
};

}  // namespace slipwise
