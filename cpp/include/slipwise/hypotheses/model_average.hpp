// SPDX-License-Identifier: Apache-2.0
// Weighting several models by how well they predict, and their average as one model over all their terms.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "slipwise/filter/causal_filter.hpp"
#include "slipwise/filter/driven_speeds.hpp"
#include "slipwise/filter/hypothesis_bank.hpp"
#include "slipwise/hypotheses/surface_memory.hpp"

namespace slipwise {

struct ModelAverageSettings {
  WeightingSettings weighting = {};
  double largest_basis = 0.4;  ///< prior weight of the basis with the most terms: of all, it is best most often [-]
  SurfaceSettings surfaces = {};
};

/// Parameters, covariance and noise of the average, over the union of all terms.
struct AverageState {
  Estimate estimate;
  Eigen::VectorXd prior_std;
  /// Posterior / prior variance per parameter over the models that have it; 1: nothing learned, more: they disagree.
  Eigen::VectorXd variance_ratio;
  Eigen::Vector3d noise_scale = {0.0, 0.0, 0.0};
  Eigen::VectorXd weights;  ///< one per model, they sum to 1
};

/// Those parameters that a model knows by name; others keep what `here` has of `names`.
Estimate known_by_name(const std::vector<ParameterInfo>& names, Estimate here, const MotionModel& from,
                       const Estimate& known);

/// Runs one causal filter per basis; with a force on the robot two, of a force that comes and goes and of one that
/// stays. Slip is linear in its parameters, so that the weighted mean of the models is again a model of the same kind:
/// the mean parameters over the union of the terms, with the spread in the covariance.
class ModelAverage {
 public:
  ModelAverage();
  /// \throws std::invalid_argument when there is no basis.
  ModelAverage(std::string name, const std::vector<Basis>& bases, ActuatorParameters learned,
               const CausalFilterSettings& filter, const ModelAverageSettings& settings);
  ModelAverage(const ModelAverage&);
  ModelAverage(ModelAverage&&) noexcept;
  ModelAverage& operator=(const ModelAverage&);
  ModelAverage& operator=(ModelAverage&&) noexcept;
  ~ModelAverage();

  /// Learns one segment with every model. Returns the update of the model that weighted most before.
  IekfUpdate learn(const InputHistory& inputs, const Segment& segment);

  /// The same in pieces: takes the segment, which `advance` then learns. The rest of the one before is learned now.
  void start(const InputHistory& inputs, const Segment& segment);

  /// One bounded piece: the update of one filter. False when the segment is learned.
  bool advance();
  /// The segment that is being learned; null between segments.
  const Segment* learning() const { return learning_ ? &learning_->segment : nullptr; }
  /// Of the last segment that was learned: the update of the model that weighted most before.
  const IekfUpdate& update() const { return update_; }

  /// Does a bounded slice of the models' refits; whether there was any to do. Results do not depend on it.
  bool refit_slice();
  /// Whether a refit took effect with the last segment.
  bool refitted() const { return std::ranges::any_of(filters_.keys(), &CausalFilter::refitted); }

  /// Something says how slip is, or may be, now.
  void take(const SlipCue& cue);

  /// The estimate of the surface that is driven on, or of the likeliest.
  SurfaceMemory remember() const;
  /// Slip may have become that of a surface just now, with this probability each; together less than 1.
  void recall(std::span<const RecalledSurface> known);
  /// The estimate while a surface is driven on, with so much `drift` since it was left.
  AverageState state_on(const SurfaceMemory& surface, double drift = 0.0) const;
  /// A surface that was never driven, where these are `known`.
  SurfaceMemory new_surface(std::span<const SurfaceMemory> known) const;
  /// The memory of all bases from one of some: of the others, the present estimate is remembered. `same_robot` says
  /// whether it goes with the parameters of this robot, as this average has them.
  /// \throws std::invalid_argument when a basis has another number of terms there.
  SurfaceMemory completed(const NamedMemory& some, bool same_robot) const;
  /// Begins with a robot that was learned before: those of its parameters that `known` has, a model's posterior.
  void know_robot(const MotionModel& known_model, const Estimate& known);
  /// Begins on a surface that is remembered, as if it had just been left after so many `seconds` of driving.
  void begin_on(const SurfaceMemory& surface, double seconds);

  const MotionModel& model() const { return model_; }
  const ModelAverageSettings& settings() const { return settings_; }
  AverageState state() const;
  /// Model of the noise, whose variances the learned scale multiplies.
  const MotionNoise& noise() const { return filters_[0].noise().shape; }
  /// Whether slip jumped before the last segment or one of those just before it, as the model says that weighted most.
  const SlipChange& change() const { return change_; }
  ReferenceSpeeds reference_speeds() const { return speeds_.reference(); }

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const ModelAverage& made) const;

  /// \throws std::invalid_argument where a loaded one does not fit the bases.
  void check_memory(const SurfaceMemory& memory) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.model_, self.filters_, self.places_, self.settings_, self.speeds_, self.change_, self.learning_);
    a(self.update_);
    self.check_sizes();
  }

 private:
  /// A segment that is being learned, and the updates so far.
  struct Learning {
    InputHistory inputs;
    Segment segment;
    std::vector<IekfUpdate> updates = {};
  };

  /// \throws std::invalid_argument unless there are as many filters and places as bases and laws of a force.
  void check_sizes() const;
  Eigen::VectorXd scores_of(const Eigen::VectorXd& weights, std::span<const IekfUpdate> updates) const;
  void update_next_filter();
  void reweigh();
  std::vector<std::size_t> side_places(std::size_t side) const;
  Eigen::VectorXd basis_weights() const;
  Eigen::VectorXd variance_ratio() const;
  AverageState state_of(std::span<const CausalFilter> filters, const Eigen::VectorXd& weights) const;
  /// Filters of each basis: laws of a force.
  std::size_t sides() const { return filters_.size() / places_.size(); }
  HypothesisBank<CausalFilter> filters_on(const SurfaceMemory& surface, double drift) const;

  MotionModel model_;
  HypothesisBank<CausalFilter> filters_;           ///< one per basis, for each law of a force
  std::vector<std::vector<Eigen::Index>> places_;  ///< of each model's parameters in the union
  ModelAverageSettings settings_;
  DrivenSpeeds speeds_;
  SlipChange change_;
  std::optional<Learning> learning_;
  IekfUpdate update_ = {};
};

}  // namespace slipwise
