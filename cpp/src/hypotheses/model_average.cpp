// SPDX-License-Identifier: Apache-2.0
// Causal model averaging, and the trial of what forgot against what did not after a change of terrain.
#include "slipwise/hypotheses/model_average.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/linear/present.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kChanged, 0.2);  // weight of the models that forgot, at first: most disturbances of real drives pass
SLIPWISE_TUNING(kActive, 0.01);  // weight from which a model has a say
SLIPWISE_TUNING(kNoisy, 4.0);    // times as large variances as those of the best poses hide a change, and look like one

/// Whether a segment comes from a source of poses that tells no change of terrain.
bool far_noisier(const Segment& segment, const Eigen::Vector3d& scale) {
  if (shows_noise(segment)) {
    return false;
  }
  return segment.measured.front().sensor.noise_factor.cwiseQuotient(scale).array().log().mean() > std::log(kNoisy);
}

/// One basis as it is, several as their union.
Basis averaged_basis(std::string name, const std::vector<Basis>& bases) {
  if (bases.empty()) {
    throw std::invalid_argument("a model average needs at least one slip basis");
  }
  return bases.size() == 1 ? bases.front() : union_basis(std::move(name), bases);
}

/// Prior weights: `largest_basis` for the basis with the most terms, the rest in equal parts.
Eigen::VectorXd prior_weights(const std::vector<Basis>& bases, double largest_basis) {
  if (!(largest_basis > 0.0) || !(largest_basis < 1.0)) {
    throw std::invalid_argument("the weight of the largest_basis basis must lie between 0 and 1, got " +
                                std::to_string(largest_basis));
  }
  const auto most = std::ranges::max_element(bases, {}, &Basis::size);
  if (bases.size() == 1) {
    return Eigen::VectorXd::Ones(1);
  }
  const auto others = static_cast<double>(bases.size() - 1);
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(std::ssize(bases), (1.0 - largest_basis) / others);
  weights[most - bases.begin()] = largest_basis;
  return weights;
}

std::vector<Eigen::Index> places_of(const MotionModel& part, const MotionModel& whole) {
  std::vector<Eigen::Index> places;
  for (const std::size_t place : parameter_places(part.basis(), whole.basis())) {
    places.push_back(static_cast<Eigen::Index>(place));
  }
  for (Eigen::Index i = part.slip_size(); i < part.size(); ++i) {
    places.push_back(whole.slip_size() + i - part.slip_size());
  }
  return places;
}

bool has_term(const Basis& basis, const std::string& name) {
  for (std::size_t i = 0; i < basis.size(); ++i) {
    if (basis.parameter_name(i) == name) {
      return true;
    }
  }
  return false;
}

/// The terms linear in V or w, which every terrain shows; all terms where the basis has none of them.
std::vector<Eigen::Index> changing_terms(const Basis& basis) {
  const Basis linear = named_basis("full-linear-6");
  std::vector<Eigen::Index> all(basis.size());
  std::iota(all.begin(), all.end(), Eigen::Index{0});
  std::vector<Eigen::Index> found;
  std::ranges::copy_if(all, std::back_inserter(found), [&](Eigen::Index i) {
    return has_term(linear, basis.parameter_name(static_cast<std::size_t>(i)));
  });
  return found.empty() ? all : found;
}

/// Of the changing terms, by their places among these: all, the forward slip that goes with V and the yaw slip that
/// goes with w together, and each of the two alone.
ChangeKinds change_kinds(const Basis& basis, const std::vector<Eigen::Index>& changing) {
  const Basis main = named_basis("edd-2");
  std::set<std::vector<Eigen::Index>> kinds;
  std::vector<Eigen::Index> all;
  std::vector<Eigen::Index> both;
  for (const Eigen::Index term : changing) {
    const Eigen::Index place = std::ssize(all);
    all.push_back(place);
    if (has_term(main, basis.parameter_name(static_cast<std::size_t>(term)))) {
      both.push_back(place);
      kinds.insert({place});
    }
  }
  kinds.insert(both);
  kinds.insert(all);
  kinds.erase(std::vector<Eigen::Index>{});
  return {kinds.begin(), kinds.end()};
}

}  // namespace

ModelAverage::ModelAverage(std::string name, const std::vector<Basis>& bases, ActuatorParameters learned,
                           const CausalFilterSettings& filter, const ModelAverageSettings& settings)
    : model_(averaged_basis(std::move(name), bases), learned),
      settings_(settings),
      changing_(changing_terms(model_.basis())),
      detector_(settings.change, change_kinds(model_.basis(), changing_)) {
  const Eigen::VectorXd prior = prior_weights(bases, settings.largest_basis);
  for (const Basis& basis : bases) {
    filters_.add(CausalFilter(MotionModel(basis, learned), filter), prior[std::ssize(places_)]);
    places_.push_back(places_of(filters_.keys().back().model(), model_));
  }
}

ModelAverage::ModelAverage() : ModelAverage("none", {MotionModel().basis()}, {}, {}, {}) {}
ModelAverage::ModelAverage(const ModelAverage&) = default;
ModelAverage::ModelAverage(ModelAverage&&) noexcept = default;
ModelAverage& ModelAverage::operator=(const ModelAverage&) = default;
ModelAverage& ModelAverage::operator=(ModelAverage&&) noexcept = default;
ModelAverage::~ModelAverage() = default;

void ModelAverage::check_sizes() const {
  const std::size_t bases = places_.size();
  bool fit = bases > 0 && filters_.size() == sides() * bases;
  for (std::size_t i = 0; fit && i < filters_.size(); ++i) {
    fit = std::ssize(places_[i % bases]) == filters_[i].model().size() &&
          filters_[i].estimate().mean.size() == filters_[i].model().size();
  }
  if (!fit) {
    throw std::invalid_argument("the filters of a model average are not those of its bases");
  }
}

IekfUpdate ModelAverage::learn(const InputHistory& inputs, const Segment& segment) {
  start(inputs, segment);
  while (advance()) {
  }
  return update_;
}

void ModelAverage::start(const InputHistory& inputs, const Segment& segment) {
  while (advance()) {
  }
  learning_ = Learning{.inputs = inputs, .segment = segment};
}

bool ModelAverage::advance() {
  if (!learning_) {
    return false;
  }
  if (!present(learning_).tested) {
    look_for_change();
    return true;
  }
  update_next_filter();
  if (present(learning_).updates.size() < filters_.size()) {
    return true;
  }
  reweigh();
  learning_.reset();
  return false;
}

bool ModelAverage::refit_slice() {
  return std::ranges::any_of(filters_.keys(), [](CausalFilter& filter) { return filter.refit_slice(); });
}

void ModelAverage::look_for_change() {
  Learning& now = present(learning_);
  speeds_.see(now.inputs, now.segment);
  moved_ = false;
  note_recent();
  change_ = undecided_ > 0 || trial_ ? ChangeTest{} : test_for_change(now.inputs, now.segment);
  if (change_.suspicion) {
    const auto first = std::ssize(recent_) - std::min<std::ptrdiff_t>(change_.segments, std::ssize(recent_));
    suspected_since_ = recent_.empty() ? now.segment.start : recent_[static_cast<std::size_t>(first)].segment.start;
    announced_ = change_.alarm;
    if (!handed_over_) {
      branch();
    }
  }
  now.tested = true;
}

void ModelAverage::update_next_filter() {
  Learning& now = present(learning_);
  const std::size_t i = now.updates.size();
  now.updates.push_back(filters_[i].learn(now.inputs, now.segment, speeds_.reference()));
}

void ModelAverage::reweigh() {
  if (trial_) {
    reweigh_trial();
    return;
  }
  const std::vector<IekfUpdate>& updates = present(learning_).updates;
  update_ = updates[filters_.heaviest()];
  const BranchBank& branches = filters_[filters_.heaviest()].branches();
  if (branches.follow()) {
    change_ = {.log_odds = branches.change_odds(), .alarm = branches.changed()};
  }
  filters_.learn(common_log_scores(filters_.weights(), updates), settings_.weighting);
  if (undecided_ > 0) {
    --undecided_;
    if (undecided_ == 0) {
      resolve();
    }
  }
}

/// By what the average predicted as it was before the segments that are tested together: the noise factors and the
/// weights follow a change at once, and would hide it.
ChangeTest ModelAverage::test_for_change(const InputHistory& inputs, const Segment& segment) {
  const ChangeSettings& change = settings_.change;
  if (!change.detect || far_noisier(segment, filters_[0].noise_scale())) {
    return {};
  }
  before_.push_back(state());
  if (std::ssize(before_) > change.longest) {
    before_.pop_front();
  }
  const AverageState& known = before_.front();
  const auto at = linearize_segment(model_, known.estimate.mean, inputs, segment);
  const RowsCovariance covariance =
      prediction_covariance(at, known.estimate.covariance, filters_[0].noise().shape, known.noise_scale);
  const Eigen::VectorXd nominal = slip_prior_std(model_.basis(), speeds_.reference(), change.fraction);
  const RowsJacobian by_change = at.by_parameter(Eigen::all, changing_) * nominal(changing_).asDiagonal();
  return detector_.see(at.path.directions(), error_of(segment, at), covariance, by_change);
}

/// Every model once as if the terrain had changed and once as it was: what follows decides between them, so that a
/// passing disturbance costs little, and the old terrain is known at once where it comes back soon.
void ModelAverage::branch() {
  before_.clear();
  detector_.restart();
  std::vector<std::size_t> twice = side_places(0);
  twice.insert(twice.end(), twice.begin(), twice.end());
  filters_ = filters_.chosen(twice);
  Eigen::VectorXd weights = (1.0 - kChanged) * filters_.weights();
  for (const std::size_t i : side_places(0)) {
    filters_[i].forget(settings_.change.forget);
    weights[static_cast<Eigen::Index>(i)] = kChanged * filters_.weights()[static_cast<Eigen::Index>(i)];
  }
  filters_.begin_with(weights, filters_.observed());
  undecided_ = settings_.change.trial;
}

void ModelAverage::forget(double fraction) {
  for (CausalFilter& filter : filters_.keys()) {
    filter.forget(fraction);
  }
}

/// Keeps the models of the terrain that predicted better.
void ModelAverage::resolve() {
  const Eigen::VectorXd weights = basis_weights();
  const bool changed = filters_.weights().head(weights.size()).sum() > filters_.weights().tail(weights.size()).sum();
  change_.alarm = changed && !announced_;
  moved_ = changed;
  filters_ = filters_.chosen(side_places(changed ? 0 : 1));
  filters_.begin_with(weights, changed ? 0 : filters_.observed());  // of a new terrain, few data have spoken
}

std::vector<std::size_t> ModelAverage::side_places(std::size_t side) const {
  std::vector<std::size_t> places(places_.size());
  std::iota(places.begin(), places.end(), side * places_.size());
  return places;
}

Eigen::VectorXd ModelAverage::basis_weights() const {
  const auto bases = static_cast<Eigen::Index>(places_.size());
  const Eigen::VectorXd& weights = filters_.weights();
  return weights.reshaped(bases, weights.size() / bases).rowwise().sum();
}

AverageState ModelAverage::state() const {
  AverageState state = state_of(filters_.keys(), filters_.weights());
  state.variance_ratio = variance_ratio();
  state.weights = basis_weights();
  return state;
}

/// The mixture of filters, the bases of one side after the other, by their weights.
AverageState ModelAverage::state_of(std::span<const CausalFilter> filters, const Eigen::VectorXd& weights) const {
  const Eigen::Index size = model_.size();
  AverageState state{{Eigen::VectorXd::Zero(size), Eigen::MatrixXd::Zero(size, size)},
                     Eigen::VectorXd::Zero(size),
                     Eigen::VectorXd(0),
                     Eigen::Vector3d::Zero(),
                     Eigen::VectorXd(0)};
  for (std::size_t i = 0; i < filters.size(); ++i) {
    const double weight = weights[static_cast<Eigen::Index>(i)];
    const std::vector<Eigen::Index>& places = places_[i % places_.size()];
    state.noise_scale += weight * filters[i].noise_scale();
    if (places.empty()) {
      continue;  // the kinematic baseline: it has no parameters, and adds nothing to any mean
    }
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(size);
    mean(places) = filters[i].estimate().mean;
    state.estimate.mean += weight * mean;
    state.estimate.covariance(places, places) += weight * filters[i].reported().covariance;
    state.estimate.covariance += weight * mean * mean.transpose();
    state.prior_std(places) = filters[i].prior_std();
  }
  state.estimate.covariance -= state.estimate.mean * state.estimate.mean.transpose();
  return state;
}

/// Over the models that have the parameter: their variances and the spread of their means, against the prior's
/// variance.
Eigen::VectorXd ModelAverage::variance_ratio() const {
  Eigen::VectorXd having = Eigen::VectorXd::Zero(model_.size());
  Eigen::VectorXd mean = having;
  Eigen::VectorXd square = having;
  Eigen::VectorXd prior = having;
  for (std::size_t i = 0; i < filters_.size(); ++i) {
    const std::vector<Eigen::Index>& places = places_[i % places_.size()];
    if (places.empty()) {
      continue;
    }
    const double weight = filters_.weights()[static_cast<Eigen::Index>(i)];
    const Estimate estimate = filters_[i].reported();
    having(places).array() += weight;
    mean(places) += weight * estimate.mean;
    square(places) += weight * (estimate.covariance.diagonal() + estimate.mean.cwiseAbs2());
    prior(places) = filters_[i].prior_std().cwiseAbs2();
  }
  const Eigen::VectorXd variance = square.cwiseQuotient(having) - mean.cwiseQuotient(having).cwiseAbs2();
  return variance.cwiseQuotient(prior);
}

}  // namespace slipwise
