// SPDX-License-Identifier: Apache-2.0
// Causal model averaging.
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

SLIPWISE_TUNING(kSloping, 0.02);  // prior weight of a basis with terms of gravity, where all others have 1 [-]
SLIPWISE_TUNING(kStays, 60.0);    // times as long as a force that comes and goes, a force that stays has its size [-]
constexpr double kEarned = 0.5;   // weight that the bases of a term of gravity need before it counts as known [-]

/// One basis as it is, several as their union.
Basis averaged_basis(std::string name, const std::vector<Basis>& bases) {
  if (bases.empty()) {
    throw std::invalid_argument("a model average needs at least one slip basis");
  }
  return bases.size() == 1 ? bases.front() : union_basis(std::move(name), bases);
}

/// Prior weights. Bases with terms of gravity have `kSloping` each: a measured attitude is as often noise, the mounting
/// or a map that lies askew as the slope of the ground. Of the rest, the one with the most terms has `largest_basis`,
/// the others equal parts.
Eigen::VectorXd prior_weights(const std::vector<Basis>& bases, double largest_basis) {
  if (!(largest_basis > 0.0) || !(largest_basis < 1.0)) {
    throw std::invalid_argument("the weight of the largest_basis basis must lie between 0 and 1, got " +
                                std::to_string(largest_basis));
  }
  const auto count = std::ssize(bases);
  const auto sloping = std::ranges::count_if(bases, &Basis::by_gravity);
  if (sloping == count) {
    return Eigen::VectorXd::Constant(count, 1.0 / static_cast<double>(count));
  }
  const double rest = 1.0 - kSloping * static_cast<double>(sloping);
  const double most = count - sloping > 1 ? largest_basis : 1.0;
  const auto others = static_cast<double>(std::max(count - sloping - 1, std::ptrdiff_t{1}));
  Eigen::VectorXd weights(count);
  std::ranges::transform(bases, weights.begin(), [&](const Basis& basis) {
    return basis.by_gravity() ? kSloping : rest * (1.0 - most) / others;
  });
  const auto level_size = [](const Basis& basis) { return basis.by_gravity() ? -1 : std::ssize(basis.terms()); };
  weights[std::ranges::max_element(bases, {}, level_size) - bases.begin()] = rest * most;
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

std::vector<ParameterInfo> after_slip(const MotionModel& model) {
  std::vector<ParameterInfo> names = model.parameters();
  names.erase(names.begin(), names.begin() + model.slip_size());
  return names;
}

}  // namespace

Estimate known_by_name(const std::vector<ParameterInfo>& names, Estimate here, const MotionModel& from,
                       const Estimate& known) {
  const std::vector<ParameterInfo> theirs = from.parameters();
  std::vector<Eigen::Index> places;
  std::vector<Eigen::Index> there;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto found = std::ranges::find(theirs, names[i].name, &ParameterInfo::name);
    if (found != theirs.end()) {
      places.push_back(static_cast<Eigen::Index>(i));
      there.push_back(found - theirs.begin());
    }
  }
  here.mean(places) = known.mean(there);
  here.covariance(places, Eigen::all).setZero();
  here.covariance(Eigen::all, places).setZero();
  here.covariance(places, places) = known.covariance(there, there);
  return here;
}

ModelAverage::ModelAverage(std::string name, const std::vector<Basis>& bases, ActuatorParameters learned,
                           const CausalFilterSettings& filter, const ModelAverageSettings& settings)
    : model_(averaged_basis(std::move(name), bases), learned), settings_(settings) {
  const Eigen::VectorXd prior = prior_weights(bases, settings.largest_basis);
  for (const Basis& basis : bases) {
    places_.push_back(places_of(MotionModel(basis, learned), model_));
  }
  std::vector<CausalFilterSettings> laws{filter};
  if (filter.force.time_constant > 0.0) {
    laws.push_back(filter);
    laws.back().force.time_constant *= kStays;
  }
  for (const CausalFilterSettings& law : laws) {
    for (std::size_t i = 0; i < bases.size(); ++i) {
      filters_.add(CausalFilter(MotionModel(bases[i], learned), law),
                   prior[static_cast<Eigen::Index>(i)] / static_cast<double>(laws.size()));
    }
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
  bool fit = bases > 0 && filters_.size() > 0 && filters_.size() == sides() * bases;
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
  speeds_.see(inputs, segment);
}

bool ModelAverage::advance() {
  if (!learning_) {
    return false;
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

void ModelAverage::update_next_filter() {
  Learning& now = present(learning_);
  const std::size_t i = now.updates.size();
  now.updates.push_back(filters_[i].learn(now.inputs, now.segment, speeds_.reference()));
}

void ModelAverage::reweigh() {
  const std::vector<IekfUpdate>& updates = present(learning_).updates;
  update_ = updates[filters_.heaviest()];
  change_ = filters_[filters_.heaviest()].branches().change();
  filters_.learn(scores_of(filters_.weights(), updates), settings_.weighting);
  if (change_.alarm) {
    filters_.begin_with(filters_.weights(), 0);  // of a new terrain, few data have spoken
  }
}

/// Log scores of one update of each basis. The slip that a basis without terms misses must not pass for noise.
Eigen::VectorXd ModelAverage::scores_of(const Eigen::VectorXd& weights, std::span<const IekfUpdate> updates) const {
  Eigen::VectorXd slipping = weights;
  for (std::size_t i = 0; i < updates.size(); ++i) {
    slipping[static_cast<Eigen::Index>(i)] *= filters_[i].model().slip_size() == 0 ? 0.0 : 1.0;
  }
  const double sum = slipping.sum();
  return common_log_scores(sum > 0.0 ? Eigen::VectorXd(slipping / sum) : weights, updates);
}

void ModelAverage::take(const SlipCue& cue) {
  std::ranges::for_each(filters_.keys(), [&](CausalFilter& filter) { filter.take(cue); });
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
  Eigen::VectorXd ratio = variance.cwiseQuotient(prior);
  for (std::size_t i = 0; i < model_.basis().size(); ++i) {
    const auto place = static_cast<Eigen::Index>(i);
    if (model_.basis().terms()[i].by_gravity() && having[place] < kEarned) {
      ratio[place] = std::max(ratio[place], 1.0);  // that a slope does nothing is not known where none was seen
    }
  }
  return ratio;
}

SurfaceMemory ModelAverage::remember() const {
  const std::size_t bases = places_.size();
  std::size_t best = 0;
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(std::ssize(places_));
  for (std::size_t side = 0; side < sides(); ++side) {
    const Eigen::VectorXd part = filters_.weights().segment(static_cast<Eigen::Index>(side * bases), weights.size());
    if (part.sum() > weights.sum()) {
      best = side;
      weights = part;
    }
  }
  SurfaceMemory memory{.slips = {}, .weights = weights / weights.sum(), .observed = filters_.observed()};
  for (std::size_t i = 0; i < bases; ++i) {
    memory.slips.push_back(filters_[best * bases + i].surface());
  }
  return memory;
}

HypothesisBank<CausalFilter> ModelAverage::filters_on(const SurfaceMemory& surface, double drift) const {
  HypothesisBank<CausalFilter> filters = filters_.chosen(side_places(0));
  for (std::size_t i = 0; i < filters.size(); ++i) {
    filters[i].go_on_with(surface.slips[i], drift);
  }
  filters.begin_with(surface.weights, surface.observed);
  return filters;
}

AverageState ModelAverage::state_on(const SurfaceMemory& surface, double drift) const {
  AverageState state = state_of(filters_on(surface, drift).keys(), surface.weights);
  state.weights = surface.weights;
  return state;
}

/// Bases are weighted as on the surfaces that are known.
SurfaceMemory ModelAverage::new_surface(std::span<const SurfaceMemory> known) const {
  SurfaceMemory fresh{.slips = {}, .weights = Eigen::VectorXd::Zero(std::ssize(places_))};
  for (std::size_t i = 0; i < places_.size(); ++i) {
    std::vector<SurfaceSlip> slips;
    std::ranges::transform(known, std::back_inserter(slips), [&](const SurfaceMemory& each) { return each.slips[i]; });
    fresh.slips.push_back(filters_[i].new_surface(slips));
  }
  for (const SurfaceMemory& each : known) {
    fresh.weights += each.weights / static_cast<double>(known.size());
  }
  return fresh;
}

void ModelAverage::recall(std::span<const RecalledSurface> known) {
  for (std::size_t i = 0; i < filters_.size(); ++i) {
    std::vector<RecalledSlip> slips;
    for (const RecalledSurface& each : known) {
      slips.push_back({.slip = each.memory.slips[i % places_.size()], .probability = each.probability});
    }
    filters_[i].recall(slips, settings_.surfaces.drift);
  }
}

SurfaceMemory ModelAverage::completed(const NamedMemory& some, bool same_robot) const {
  SurfaceMemory all = remember();
  all.observed = some.memory.observed;
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(std::ssize(places_));
  for (std::size_t i = 0; i < all.slips.size(); ++i) {
    const auto named = std::ranges::find(some.bases, filters_[i].model().basis().name());
    if (named == some.bases.end()) {
      continue;
    }
    const auto place = static_cast<std::size_t>(named - some.bases.begin());
    SurfaceSlip slip = some.memory.slips.at(place);
    const SurfaceSlip& own = all.slips[i];
    if (slip.mean.size() != own.mean.size()) {
      throw std::invalid_argument("a surface has " + std::to_string(slip.mean.size()) + " terms of the basis '" +
                                  *named + "' where there are " + std::to_string(own.mean.size()) +
                                  ": give the settings that it was learned with");
    }
    if (!same_robot || slip.robot.size() != own.robot.size()) {
      slip.robot = own.robot;
      slip.by_robot = Eigen::MatrixXd::Zero(own.by_robot.rows(), own.by_robot.cols());
    }
    slip.prior_std = filters_[i].slip_std_at(slip.speeds);
    slip.noise_scale = NoiseScale(filters_[i].noise(), slip.noise_scale.value());
    weights[static_cast<Eigen::Index>(i)] = some.memory.weights[static_cast<Eigen::Index>(place)];
    all.slips[i] = std::move(slip);
  }
  all.weights = weights.sum() > 0.0 ? Eigen::VectorXd(weights / weights.sum())
                                    : Eigen::VectorXd(filters_.prior().head(weights.size()));
  return all;
}

void ModelAverage::know_robot(const MotionModel& known_model, const Estimate& known) {
  const std::vector<ParameterInfo> names = after_slip(model_);
  const auto size = std::ssize(names);
  for (CausalFilter& filter : filters_.keys()) {
    const Estimate& now = filter.estimate();
    filter.know_robot(
        known_by_name(names, {now.mean.tail(size), now.covariance.bottomRightCorner(size, size)}, known_model, known));
  }
}

void ModelAverage::begin_on(const SurfaceMemory& surface, double seconds) {
  filters_ = filters_on(surface, 0.0);
  speeds_.begin_with(surface.slips.back().speeds, seconds);
}

}  // namespace slipwise
