// SPDX-License-Identifier: Apache-2.0
// What has to hold of filters that are loaded.
#include <algorithm>
#include <ranges>

#include "slipwise/archive/bytes.hpp"
#include "slipwise/archive/same.hpp"
#include "slipwise/filter/causal_filter.hpp"

namespace slipwise {
namespace {

using archive::require;

bool has_size(const Estimate& estimate, Eigen::Index size) { return estimate.mean.size() == size; }

/// Of so many parameters, from the `first` on: those before it may have been used up.
bool have_parameters(const std::vector<SegmentLinearization>& all, Eigen::Index size, std::size_t first = 0) {
  return std::ranges::all_of(all | std::views::drop(first), [&](const SegmentLinearization& at) {
    return at.by_parameter.cols() == size && !at.path.poses.empty();
  });
}

}  // namespace

void ScoreCovariance::check_loaded(Eigen::Index size) const {
  const auto square = [&](const Eigen::MatrixXd& matrix) { return matrix.rows() == size && matrix.cols() == size; };
  require(square(information_) && square(scatter_) && square(lagged_) && earlier_.size() == size,
          "scores are of other parameters");
  for (const auto& group : groups_) {
    require(std::ranges::all_of(group, [&](Eigen::Index place) { return 0 <= place && place < size; }),
            "a group of scores names a parameter that is not there");
  }
}

void BatchSearch::check_loaded(const MotionModel& model, std::size_t data) const {
  const Eigen::Index size = model.size();
  require(archive::same(model_, model) && has_size(prior_, size) && data_.size() == data &&
              prior_information_.rows() == size && prior_information_.cols() == size && search_.has_size(size),
          "a search is of another model");
  require(at_.size() < data && have_parameters(at_, size), "a search has linearised other data");
  require((best_ || !search_.over()) && (!best_ || (best_->equations.gradient.size() == size &&
                                                    best_->at.size() == data && have_parameters(best_->at, size))),
          "a search has lost what it found");
}

void FilterRefit::check_loaded(const MotionModel& model, std::size_t kept) const {
  const Eigen::Index size = model.size();
  require(archive::same(model_, model) && has_size(before_, size) && has_size(state_.estimate, size),
          "a refit is of another model");
  state_.scores.check_loaded(size);
  require(count_ <= kept && done_ <= kept && (phase_ == Phase::Follow || done_ <= count_),
          "a refit is of segments that are not kept");
  require(places_.size() == data_.size() && fitted_ <= data_.size() && have_parameters(at_, size, fitted_) &&
              (at_.empty() || at_.size() == data_.size()),
          "the data of a refit do not fit together");
  require(phase_ != Phase::Noise || at_.size() == data_.size(), "a refit has lost its fit");
  require(phase_ != Phase::Search || search_, "a refit has lost its search");
  if (search_) {
    search_->check_loaded(model, data_.size());
  }
}

void BranchBank::check_loaded(const BranchBank& made, Eigen::Index parameters) const {
  require(archive::same(kinds_, made.kinds_) && archive::same(settings_, made.settings_),
          "branches are of another model or of other settings");
  require((branches_.size() > 0) == (made.branches_.size() > 0) &&
              std::ranges::all_of(branches_.keys(),
                                  [&](const Branch& branch) {
                                    return has_size(branch.estimate, parameters) && branch.number <= births_ &&
                                           branch.estimate.covariance.rows() == parameters &&
                                           branch.estimate.covariance.cols() == parameters;
                                  }),
          "branches have other parameters than their model");
  require(std::ranges::all_of(alike_, [](double alike) { return alike >= 0.0; }),
          "segments that count as one are less than none");
}

void CausalFilter::check_loaded(const CausalFilter& made) const {
  const Eigen::Index size = made.model_.size();
  require(archive::same(model_, made.model_) && archive::same(settings_, made.settings_) &&
              archive::same(force_, made.force_),
          "a filter is of another model or of other settings");
  require(has_size(state_.estimate, size) && has_size(before_, size) && slip_std_.size() == model_.slip_size() &&
              stated_.size() == size,
          "a filter has other parameters than its model");
  require(speeds_.v > 0.0 && speeds_.omega > 0.0 && slip_std_.allFinite(), "a filter has no prior");
  state_.scores.check_loaded(size);
  branches_.check_loaded(made.branches_, size);
  if (refit_) {
    require(refit_->slip_std.size() == slip_std_.size() && refit_->begun <= kept_.size(), "a refit began later");
    refit_->work.check_loaded(model_, kept_.size());
  }
}

}  // namespace slipwise
