// SPDX-License-Identifier: Apache-2.0
// What has to hold of averages, surfaces and structures that are loaded.
#include <algorithm>
#include <array>
#include <functional>

#include "slipwise/archive/bytes.hpp"
#include "slipwise/archive/same.hpp"
#include "slipwise/hypotheses/motion_hypotheses.hpp"
#include "slipwise/linear/present.hpp"

namespace slipwise {
namespace {

using archive::require;

bool are_weights(const auto& weights) {
  return std::ranges::all_of(weights, [](double weight) { return weight >= 0.0 && weight <= 2.0; }) &&
         std::ranges::any_of(weights, [](double weight) { return weight > 0.0; });
}

bool are_places(const std::vector<Eigen::Index>& places, Eigen::Index size) {
  return std::ranges::all_of(places, [&](Eigen::Index place) { return 0 <= place && place < size; });
}

void check_state(const AverageState& state, Eigen::Index size) {
  require(state.estimate.mean.size() == size && state.prior_std.size() == size &&
              (state.variance_ratio.size() == 0 || state.variance_ratio.size() == size) &&
              state.noise_scale.allFinite(),
          "the state of an average has other parameters than its model");
}

}  // namespace

void SurfaceEvidence::check_loaded(const MotionModel& model) const {
  const Eigen::Index size = model.size();
  require(posterior_.estimate.mean.size() == size && posterior_.prior_std.size() == size && are_places(places_, size) &&
              under_.size() > 0,
          "the evidence for a surface is of other parameters");
  const Eigen::Index all = size + std::ssize(places_);
  for (const Under& under : under_.keys()) {
    require(under.nominal.size() == std::ssize(places_) && under.state.size() == all &&
                under.covariance.rows() == all && under.covariance.cols() == all && under.time_constant > 0.0,
            "the evidence for a surface does not fit together");
  }
}

void ModelAverage::check_memory(const SurfaceMemory& memory) const {
  require(memory.slips.size() == places_.size() && are_weights(memory.weights), "a surface has other bases");
  for (std::size_t i = 0; i < memory.slips.size(); ++i) {
    const MotionModel& model = filters_[i].model();
    const SurfaceSlip& slip = memory.slips[i];
    require(slip.mean.size() == model.slip_size() && slip.robot.size() == model.size() - model.slip_size() &&
                slip.speeds.v > 0.0 && slip.speeds.omega > 0.0,
            "a surface has other terms than its basis");
  }
}

void ModelAverage::check_loaded(const ModelAverage& made) const {
  require(filters_.size() == made.filters_.size() && archive::same(model_, made.model_) && places_ == made.places_ &&
              archive::same(settings_, made.settings_) && are_weights(filters_.weights()),
          "an average is of other bases or settings");
  for (std::size_t i = 0; i < filters_.size(); ++i) {
    filters_[i].check_loaded(made.filters_[i]);
  }
  require(0 <= change_.segments, "an average has found a change after the last segment");
  require(!learning_ || (learning_->updates.size() < filters_.size()), "an average has learned more than it has");
}

void RememberingAverage::check_loaded(const RememberingAverage& made) const {
  average_.check_loaded(made.average_);
  for (const Recent& recent : recent_) {
    average_.check_memory(recent.memory);
    check_state(recent.state, average_.model().size());
  }
  if (parting_) {
    average_.check_memory(*parting_);
  }
}

void SurfaceTrial::check_loaded(const MotionModel& model, std::size_t surfaces) const {
  using Kind = SurfaceCandidate::Kind;
  const auto there = [&](const SurfaceCandidate& candidate) {
    const auto alike = [&](const SurfaceCandidate& each) {
      return each.kind == Kind::Alike && each.place == candidate.place;
    };
    return candidate.kind != Kind::Known ||
           (candidate.place < surfaces && std::ranges::any_of(candidates_, alike));  // it goes on against that
  };
  require(!candidates_.empty() && evidence_.size() == candidates_.size() && are_weights(evidence_.weights()),
          "a trial of surfaces does not fit together");
  require(std::ranges::all_of(candidates_, there), "a trial is of a surface that is not there");
  for (const SurfaceEvidence& evidence : evidence_.keys()) {
    evidence.check_loaded(model);
  }
}

void SurfaceBank::check_loaded(const SurfaceBank& made,
                               const std::array<const RememberingAverage*, kAverages>& averages) const {
  require(archive::same(settings_, made.settings_) &&
              (!surfaces_.present() || *surfaces_.present() < surfaces_.size()) && leader_ < kAverages &&
              averages[leader_] != nullptr,
          "the bank of surfaces names one that is not there");
  for (const Surface& surface : surfaces_.all()) {
    for (std::size_t i = 0; i < kAverages; ++i) {
      const auto& memory = surface.memories[i];
      require(!memory || averages[i] != nullptr, "a surface is remembered without an average");
      if (memory) {
        averages[i]->average().check_memory(*memory);
      }
    }
  }
  require(!held_ || (trial_ && surfaces_.present()), "a surface is doubted that is not driven on");
  if (trial_) {
    trial_->check_loaded(averages[leader_]->average().model(), surfaces_.size());
    const std::size_t count = trial_->candidates().size();
    require(held_ ? count == 2 : heard_.fits(count), "a trial of surfaces has other candidates");
  }
}

void CascadedModel::check_loaded(const CascadedModel& made) const {
  require(archive::same(model_, made.model_) && archive::same(noise_, made.noise_) &&
              places_of_slip_ == made.places_of_slip_ && places_of_actuator_ == made.places_of_actuator_ &&
              posterior_ && archive::same(posterior_->model, model_) &&
              known_slip_.holds(made.slip_.average().model().size()) &&
              known_actuator_.holds(std::ssize(places_of_actuator_)),
          "a cascade is of another model");
  slip_.check_loaded(made.slip_);
  actuator_.check_loaded(made.actuator_);
}

void Structures::check_loaded(const Structures& made) const {
  require(archive::same(settings_, made.settings_) && direct_bases_ == made.direct_bases_ &&
              direct_.has_value() == made.direct_.has_value() && cascaded_.has_value() == made.cascaded_.has_value() &&
              are_weights(tried_.weights()),
          "the learned terms are not those of the settings");
  joint_.check_loaded(made.joint_);
  if (direct_) {
    direct_->check_loaded(present(made.direct_));
  }
  if (cascaded_) {
    cascaded_->check_loaded(present(made.cascaded_));
  }
  const auto there = [&](Structure structure) {
    return structure == Structure::Joint || structure == Structure::Baseline ||
           (structure == Structure::Direct && direct_) || (structure == Structure::Cascaded && cascaded_);
  };
  require(std::ranges::all_of(tried_.keys(), there) && tried(Structure::Joint) &&
              std::ranges::adjacent_find(tried_.keys(), std::greater_equal()) == tried_.keys().end(),
          "a structure is tried that is not there");
}

void MotionHypotheses::check_loaded(const MotionHypotheses& made) const {
  structures_.check_loaded(made.structures_);
  bank_.check_loaded(made.bank_, structures_.averages());
  require(predicted_.size() <= to_predict_.size() && (!segment_ || to_predict_ == structures_.tried()),
          "a segment is predicted by a structure that is not there");
}

}  // namespace slipwise
