// SPDX-License-Identifier: Apache-2.0
// The surfaces that a robot has driven on: which one it is on, when it comes to another, and what is remembered.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "slipwise/hypotheses/heard_terrain.hpp"
#include "slipwise/hypotheses/remembering_average.hpp"
#include "slipwise/hypotheses/surface_labels.hpp"
#include "slipwise/hypotheses/surface_list.hpp"
#include "slipwise/hypotheses/surface_probability.hpp"
#include "slipwise/hypotheses/surface_trial.hpp"
#include "slipwise/hypotheses/surface_visit.hpp"

namespace slipwise {

using Averages = std::array<RememberingAverage*, kAverages>;

/// What a learner knows of slip: by its averages, of which null are those that are not tried.
struct LearnedSlip {
  Averages averages;
  std::size_t leader;    ///< the average that tells surfaces apart soonest
  DisturbanceModel law;  ///< of the slip disturbance

  /// Calls `use` with the place and the average of each that is tried.
  template <class Use>
  void for_each(const Use& use) const {
    for (std::size_t i = 0; i < averages.size(); ++i) {
      if (averages[i] != nullptr) {
        use(i, *averages[i]);
      }
    }
  }
};

/// Facts about a drive's start.
struct DriveStart {
  std::string label = {};  ///< name of the surface, if a label gives it
  std::string date = {};
};

/// Says which surface is driven on, opens another where none of those known fits, and gives the filters those that may
/// have come back. Who wins a trial gives a name: what predicts follows its branches (derivations/surfaces.md).
class SurfaceBank {
 public:
  explicit SurfaceBank(const SurfaceSettings& settings = {}) : settings_(settings) {}

  /// A drive begins somewhere: any known surface, or a new one.
  void start_drive(const LearnedSlip& learned, const DriveStart& start);
  /// A label says that the surface is `label`, or another from now on where that is empty.
  void cue(const LearnedSlip& learned, const std::string& label);
  /// A sensor says what the terrain under the robot is: where another surface explains it far better than the present
  /// one, a trial begins.
  void hear(const LearnedSlip& learned, const TerrainAnswer& answer);
  /// After each segment: changes that the leading average found open trials, and the evidence of its segments ends
  /// them.
  void consider(const LearnedSlip& learned);
  /// Counts a segment that was driven on the present surface.
  void see(const InputHistory& inputs, const Segment& segment);

  /// The surface that is driven on is remembered as it is now.
  void keep_present(const LearnedSlip& learned);
  const std::vector<Surface>& surfaces() const { return surfaces_.all(); }
  /// The one that is driven on; empty if that is open, or it has no entry yet.
  std::optional<std::size_t> present() const { return surfaces_.present(); }
  /// How probable each surface is to be the one under the robot; nothing where none are remembered.
  std::vector<SurfaceProbability> probabilities() const;
  /// What happened since the last call.
  std::vector<SurfaceEvent> take_events() { return surfaces_.take_events(); }
  const LabelCounts& labels() const { return labels_.counts(); }
  /// Begins with surfaces that were learned before.
  void know(std::vector<Surface> surfaces, const LabelCounts& labels);
  /// Takes in surfaces of another memory of the same robot. One that cannot be distinguished from a known one
  /// becomes one with it; one whose name is taken gets a number. Returns their names here.
  std::vector<std::string> add(const LearnedSlip& learned, std::vector<Surface> others);

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become
  /// beside these averages.
  void check_loaded(const SurfaceBank& made, const std::array<const RememberingAverage*, kAverages>& averages) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.settings_, self.surfaces_, self.visit_, self.labels_, self.leader_, self.heard_, self.trial_, self.held_);
  }

 private:
  void open(const LearnedSlip& learned, std::vector<SurfaceCandidate> candidates, double since);
  void settle(const LearnedSlip& learned, bool at_once);
  void suspect(const LearnedSlip& learned);
  void doubt();
  bool let_go();
  void leave_present(const LearnedSlip& learned);
  void merge_confounded(const LearnedSlip& learned, std::size_t place);

  SurfaceSettings settings_;
  SurfaceList surfaces_;
  SurfaceVisit visit_;
  SurfaceLabels labels_;
  std::size_t leader_ = 0;  ///< average that decides, in a trial to its end
  HeardTerrain heard_;
  std::optional<SurfaceTrial> trial_;  ///< what competes to be the present surface; empty if that is settled
  bool held_ = false;                  ///< the trial is of the surface that was recalled, against one that is like it
};

}  // namespace slipwise
