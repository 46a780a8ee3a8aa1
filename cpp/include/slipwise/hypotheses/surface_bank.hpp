// SPDX-License-Identifier: Apache-2.0
// The surfaces that a robot has driven on: which one it is on, when it comes to another, and what is remembered.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "slipwise/filter/driven_speeds.hpp"
#include "slipwise/hypotheses/remembering_average.hpp"
#include "slipwise/hypotheses/surface_classes.hpp"
#include "slipwise/hypotheses/surface_list.hpp"
#include "slipwise/hypotheses/surface_trial.hpp"

namespace slipwise {

using Averages = std::array<RememberingAverage*, kAverages>;

/// Facts about a drive's start.
struct DriveStart {
  std::string label = {};  ///< name of the surface, if a label gives it
  std::string date = {};
};

/// How much was driven, and how fast.
struct Driven {
  double seconds = 0.0;
  std::size_t segments = 0;
  DrivenSpeeds speeds = {};

  void see(const InputHistory& inputs, const Segment& segment);
  /// What was driven later is of the same surface.
  void take_in(const Driven& later);

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.seconds, self.segments, self.speeds);
  }
};

/// How often labels named the surface that was then taken.
struct LabelCounts {
  double all = 0.0;
  double right = 0.0;
};

/// Says which surface is driven on, opens another where none of those known fits, and gives the filters those that may
/// have come back. Who wins a trial gives a name: what predicts follows its branches (derivations/surfaces.md).
class SurfaceBank {
 public:
  SurfaceBank() = default;
  explicit SurfaceBank(const SurfaceSettings& settings);

  /// A drive begins somewhere: any known surface, or a new one.
  void start_drive(const Averages& averages, const DisturbanceModel& law, const DriveStart& start);
  /// A label says that the surface is `label`, or another from now on where that is empty.
  void cue(const Averages& averages, const DisturbanceModel& law, const std::string& label);
  /// A sensor says what the terrain under the robot is. In a trial all that it said counts as one cue, since answers
  /// miss alike; where another surface explains it far better than the present one, a trial begins.
  void hear(const Averages& averages, const DisturbanceModel& law, const TerrainAnswer& answer);
  /// After each segment: changes that the average `leader` found open trials, and the evidence of its segments ends
  /// them. Whether a trial ended.
  bool consider(const Averages& averages, std::size_t leader, const DisturbanceModel& law);
  /// Counts a segment that was driven on the present surface.
  void see(const InputHistory& inputs, const Segment& segment);

  /// The surface that is driven on is remembered as it is now.
  void keep_present(const Averages& averages, const DisturbanceModel& law);
  const std::vector<Surface>& surfaces() const { return surfaces_.all(); }
  /// The one that is driven on; empty if that is open, or it has no entry yet.
  std::optional<std::size_t> present() const { return surfaces_.present(); }
  /// The name of a candidate; empty where it has none, as one that changed: it becomes another when it is taken.
  std::string name_of(const SurfaceCandidate& candidate) const;
  /// What competes to be it; empty if that is settled.
  const std::optional<SurfaceTrial>& trial() const { return trial_; }
  /// What happened since the last call.
  std::vector<SurfaceEvent> take_events() { return surfaces_.take_events(); }
  /// How often labels are right: the mean of a Beta distribution that began with 9 of 10.
  double label_reliability() const { return (labels_.right + 9.0) / (labels_.all + 10.0); }
  const LabelCounts& labels() const { return labels_; }
  /// Begins with surfaces that were learned before.
  void know(std::vector<Surface> surfaces, const LabelCounts& labels);
  /// Takes in surfaces of another memory of the same robot. One that cannot be distinguished from a known one
  /// becomes one with it; one whose name is taken gets a number. Returns their names here.
  std::vector<std::string> add(const Averages& averages, const DisturbanceModel& law, std::vector<Surface> others,
                               std::size_t leader);
  const SurfaceSettings& settings() const { return settings_; }

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become
  /// beside these averages.
  void check_loaded(const SurfaceBank& made, const std::array<const RememberingAverage*, kAverages>& averages) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.settings_, self.surfaces_, self.driven_, self.driven_in_trial_, self.date_);
    a(self.label_, self.wanted_, self.labels_, self.leader_);
    a(self.heard_, self.heard_in_trial_, self.heard_factors_, self.doubted_for_, self.trial_, self.held_);
  }

 private:
  void open(const Averages& averages, const DisturbanceModel& law, std::vector<SurfaceCandidate> candidates,
            double since);
  Eigen::ArrayXd label_factors(const std::vector<SurfaceCandidate>& candidates) const;
  ClassCounts heard_on_present() const;
  Eigen::ArrayXd class_likelihoods(const std::vector<SurfaceCandidate>& candidates, const ClassCounts& said) const;
  void weigh_by_classes(const Averages& averages);
  void hear_on(SurfaceCandidate::Kind taken);
  void weigh_by_label(std::vector<SurfaceCandidate>& candidates) const;
  std::string judge_label(const SurfaceCandidate& candidate, const std::string& recalled, bool sure);
  bool settle(const Averages& averages, const DisturbanceModel& law, bool at_once);
  void suspect(const Averages& averages, const DisturbanceModel& law);
  bool doubt();
  void let_go();
  void weigh_trial(const Averages& averages, const Eigen::VectorXd& log_factors);
  void recall(const Averages& averages) const;
  void leave_present(const Averages& averages, const DisturbanceModel& law);
  void take(const SurfaceCandidate& candidate, const std::string& recalled, double probability, int segments);
  void enter_new();
  void flush(Surface& surface);
  void merge_confounded(const Averages& averages, const DisturbanceModel& law, std::size_t place);

  SurfaceSettings settings_;
  SurfaceList surfaces_;
  Driven driven_;           ///< on the present surface since it was taken
  Driven driven_in_trial_;  ///< since the trial began, on the surface that it will say
  std::string date_;
  std::string label_;   ///< that speaks in the trial
  std::string wanted_;  ///< name of the surface that has no entry yet
  LabelCounts labels_;
  std::size_t leader_ = 0;             ///< average that decides, in a trial to its end
  ClassCounts heard_;                  ///< said by sensors on the present surface since it was taken
  ClassCounts heard_in_trial_;         ///< since the trial began
  std::vector<double> heard_factors_;  ///< log factors of the candidates that this has been worth so far
  std::string doubted_for_;            ///< class that began the last trial on the present surface
  std::optional<SurfaceTrial> trial_;
  bool held_ = false;  ///< the trial is of the surface that was recalled, against one that is like it
};

}  // namespace slipwise
