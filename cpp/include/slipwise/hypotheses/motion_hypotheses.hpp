// SPDX-License-Identifier: Apache-2.0
// How motion is explained: by slip, lag and delay, by less, or by wheel speeds too; whichever predicts better.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "slipwise/filter/hypothesis_bank.hpp"
#include "slipwise/filter/motion_posterior.hpp"
#include "slipwise/filter/predictive_score.hpp"
#include "slipwise/hypotheses/cascaded_model.hpp"
#include "slipwise/hypotheses/model_average.hpp"
#include "slipwise/hypotheses/remembering_average.hpp"
#include "slipwise/hypotheses/surface_bank.hpp"
#include "slipwise/hypotheses/surface_probability.hpp"
#include "slipwise/segment/driven_segment.hpp"

namespace slipwise {

/// Those that ship and are averaged: the kinematic baseline first, then more and more terms.
std::vector<Basis> averaged_bases();

/// What the learner learns.
struct HypothesisSettings {
  std::vector<Basis> bases = averaged_bases();  ///< averaged, or one
  bool dynamics = true;                         ///< inputs are commands: lag and delay are learned
  bool clock_offset = true;                     ///< learned, where inputs are wheel speeds
  bool sensor_extrinsics = false;               ///< where the pose sensor sits is learned
  bool cascaded = true;  ///< from commands, once wheel speeds come: also learn the actuator from these
  bool direct = true;    ///< from commands: also try slip and delays, no lag
  bool baseline = true;  ///< also try the kinematic baseline
  /// From commands to a robot that steers, whose lags and delays act on the curvature of its path [m]; 0: it does not.
  double wheelbase = 0.0;
  CausalFilterSettings filter = {};
  ModelAverageSettings average = {};

  /// Whether more than one structure may come to be tried.
  bool several() const { return baseline || (dynamics && (cascaded || direct)); }
};

/// Slip of a surface in the terms of one structure.
struct SlipOnSurface {
  AverageState state;            ///< of the average of all bases
  NamedMemory memory;            ///< of each
  ReferenceSpeeds prior_speeds;  ///< of the prior under which it was learned
};

/// A surface that another learner knew.
struct KnownSurface {
  Surface facts;  ///< its memories are not used
  NamedMemory memory;
};

/// What a learner begins with: the model, surfaces and labels of another one.
struct KnownBefore {
  MotionPosterior model;
  std::vector<KnownSurface> surfaces;
  LabelCounts labels;
};

/// How one structure took a segment in.
struct StructureUpdate {
  double nis = 0.0;     ///< of the segment before it was learned
  double weight = 1.0;  ///< how much it counted: 0 rejected
  SlipChange change = {};
  bool refitted = false;  ///< whether a refit of its filters took effect
};

/// Runs all structures causally and weights them by their predictive likelihood, as bases are weighted. Predictions are
/// those of the heaviest: they have different parameters, which have no mean. How an actuator answers does not change
/// with the terrain: a simpler structure that is refuted once is dropped for good.
class MotionHypotheses {
 public:
  explicit MotionHypotheses(const HypothesisSettings& settings);

  /// Begins to learn one segment. `wheels_known` says whether wheel speeds came beside the commands so far.
  void start(const DrivenSegment& segment, bool wheels_known);
  /// Does a bounded piece of it; whether there is more to do.
  bool advance();
  /// Begins to learn the slip of the cascaded structure; `advance_slip` does a piece of it, and says whether there is
  /// more.
  void start_slip(const DrivenSegment& segment);
  bool advance_slip();
  /// Learns its actuator.
  void learn_actuator(const WheelSegment& segment);
  /// Does a bounded slice of the refits of all filters; whether there was any to do. Results do not depend on it.
  bool refit_slice();
  /// Something beside segments says how slip is, or may be, now.
  void take(const SlipCue& cue);
  /// Another drive begins: on a surface that is remembered, or a new one. `law` is the slip disturbance as it is known.
  void start_drive(const DisturbanceModel& law, const DriveStart& start);
  /// Segments of one run are not joined with those of another.
  void start_run();
  /// The surfaces as they are known now, the present one included, and which one that is.
  SurfaceBank surfaces_now(const DisturbanceModel& law) const;
  /// The surfaces that the structures share.
  SurfaceBank& bank() { return bank_; }
  const SurfaceBank& bank() const { return bank_; }
  /// What is known of slip now, which the bank needs: by the averages of the structures that are tried.
  LearnedSlip learned_slip(const DisturbanceModel& law);
  /// The estimate of a surface in the terms of a structure; empty if it has no memory.
  std::optional<SlipOnSurface> on_surface(const Surface& surface, Structure structure) const;
  /// The same of the surface that is driven on, whether surfaces are remembered or not.
  std::optional<SlipOnSurface> slip_now(Structure structure) const;
  /// Begins with what another learner knew, before anything is learned. `wheels_known` says whether wheel speeds come
  /// beside the commands.
  /// \throws std::invalid_argument when something was learned already, or the terms are not those that are learned.
  void begin_with(const KnownBefore& known, double segment_length, bool wheels_known);
  /// Takes in what another learner of the same robot remembers (`SurfaceBank::add`).
  std::vector<std::string> add_surfaces(const DisturbanceModel& law, const KnownBefore& other);

  /// What the heaviest structure knows.
  std::shared_ptr<const MotionPosterior> posterior() const;
  /// The same among structures with slip, which the baseline has not.
  std::shared_ptr<const MotionPosterior> slip_posterior() const;
  /// What one structure knows; empty if it is not tried.
  std::shared_ptr<const MotionPosterior> of(Structure structure) const;
  /// Weight of each structure; 0 where it is not tried.
  std::array<double, kStructures> weights() const;
  /// How each structure took the last segment in.
  const std::array<StructureUpdate, kStructures>& updates() const { return updates_; }
  /// Segments learned.
  std::size_t count() const { return count_; }

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const MotionHypotheses& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.settings_, self.joint_, self.direct_, self.direct_bases_, self.cascaded_, self.baseline_, self.tried_);
    a(self.updates_, self.count_, self.segment_, self.to_predict_, self.predicted_, self.averaging_);
    a(self.bank_, self.begun_with_);
  }

 private:
  bool tried(Structure structure) const { return tried_.place_of(structure) < tried_.size(); }
  void join_cascade();
  void favour_known();
  /// Of the structures that may come to be tried.
  template <class Self>
  static auto averages_of(Self& self) {
    using Average = std::conditional_t<std::is_const_v<Self>, const RememberingAverage, RememberingAverage>;
    return std::array<Average*, kAverages>{&self.joint_, self.direct_ ? &*self.direct_ : nullptr,
                                           self.cascaded_ ? &self.cascaded_->slip() : nullptr};
  }
  ScoredSegment predict(Structure structure);
  RememberingAverage* average_of(Structure structure);
  ScoredSegment learned(const ModelAverage& average, Structure structure);
  Surface completed(const KnownSurface& known, std::size_t place) const;
  void update_weights();
  void drop_refuted();
  std::shared_ptr<const MotionPosterior> posterior_of(const ModelAverage& average, Structure structure) const;

  HypothesisSettings settings_;
  RememberingAverage joint_;
  std::optional<RememberingAverage> direct_;
  std::vector<Eigen::Index> direct_bases_;  ///< their places among all bases
  std::optional<CascadedModel> cascaded_;
  PredictiveScore baseline_;
  HypothesisBank<Structure> tried_;  ///< in the order of their values
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
