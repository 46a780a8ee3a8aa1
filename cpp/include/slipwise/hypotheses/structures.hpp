// SPDX-License-Identifier: Apache-2.0
// How motion may be explained: by slip, lag and delay, by less, or by wheel speeds too; and what each has learned.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "slipwise/filter/hypothesis_bank.hpp"
#include "slipwise/filter/motion_posterior.hpp"
#include "slipwise/filter/predictive_score.hpp"
#include "slipwise/hypotheses/cascaded_model.hpp"
#include "slipwise/hypotheses/model_average.hpp"
#include "slipwise/hypotheses/remembering_average.hpp"
#include "slipwise/hypotheses/surface.hpp"
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

/// The structures that are tried, weighted by their predictive likelihood as bases are. Predictions are those of the
/// heaviest: they have different parameters, which have no mean. How an actuator answers does not change with the
/// terrain: a simpler structure that is refuted once is dropped for good.
class Structures {
 public:
  explicit Structures(const HypothesisSettings& settings);

  const HypothesisSettings& settings() const { return settings_; }
  /// Of the structures that may come to be tried; null where one may not.
  std::array<RememberingAverage*, kAverages> averages() { return averages_of(*this); }
  std::array<const RememberingAverage*, kAverages> averages() const { return averages_of(*this); }
  /// Names of the bases of one of these.
  std::vector<std::string> basis_names(std::size_t average) const;
  CascadedModel* cascaded() { return cascaded_ ? &*cascaded_ : nullptr; }
  const CascadedModel* cascaded() const { return cascaded_ ? &*cascaded_ : nullptr; }

  /// Those that are tried, in the order of their values.
  const std::vector<Structure>& tried() const { return tried_.keys(); }
  bool tried(Structure structure) const { return tried_.place_of(structure) < tried_.size(); }
  /// Tries the cascade too, where there is one and wheel speeds came. Whether it was not tried before.
  bool join_cascade(bool wheels_known);
  /// One begins as the likeliest, if it is tried.
  void favour(Structure structure);

  /// What learns the segments themselves, of a structure; null where its estimate comes from elsewhere.
  RememberingAverage* average_of(Structure structure);
  /// How such a structure predicts a segment.
  ScoredSegment score(Structure structure, const DrivenSegment& segment);
  /// Weights follow from how those that are tried predicted a segment, in their order.
  void learn(std::span<const ScoredSegment> predicted);
  /// Something beside segments says how slip is, or may be, now.
  void take(const SlipCue& cue);
  /// Does a bounded slice of the refits of all filters; whether there was any to do. Results do not depend on it.
  bool refit_slice();

  /// Weight of each structure; 0 where it is not tried.
  std::array<double, kStructures> weights() const;
  /// What one structure knows; empty if it is not tried.
  std::shared_ptr<const MotionPosterior> of(Structure structure) const;
  /// What the heaviest knows.
  std::shared_ptr<const MotionPosterior> posterior() const { return of(tried_[tried_.heaviest()]); }
  /// The same among structures with slip, which the baseline has not.
  std::shared_ptr<const MotionPosterior> slip_posterior() const;

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const Structures& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.settings_, self.joint_, self.direct_, self.direct_bases_, self.cascaded_, self.baseline_, self.tried_);
  }

 private:
  template <class Self>
  static std::array<std::conditional_t<std::is_const_v<Self>, const RememberingAverage, RememberingAverage>*, kAverages>
  averages_of(Self& self) {
    return {&self.joint_, self.direct_ ? &*self.direct_ : nullptr, self.cascaded_ ? &self.cascaded_->slip() : nullptr};
  }
  void drop_refuted();
  std::shared_ptr<const MotionPosterior> posterior_of(const ModelAverage& average, Structure structure) const;

  HypothesisSettings settings_;
  RememberingAverage joint_;
  std::optional<RememberingAverage> direct_;
  std::vector<Eigen::Index> direct_bases_;  ///< their places among all bases
  std::optional<CascadedModel> cascaded_;
  PredictiveScore baseline_;
  HypothesisBank<Structure> tried_;  ///< in the order of their values
};

}  // namespace slipwise
