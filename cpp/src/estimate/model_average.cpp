// SPDX-License-Identifier: Apache-2.0
// Causal model averaging with a fixed share (Herbster and Warmuth 1998) of a tempered predictive density (Gruenwald
// 2012).
#include "slipwise/estimate/model_average.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/estimate/predictive_score.hpp"

namespace slipwise {
namespace {

/// One basis as it is, several as their union.
Basis averaged_basis(std::string name, const std::vector<Basis>& bases) {
  if (bases.empty()) {
    throw std::invalid_argument("a model average needs at least one slip basis");
  }
  return bases.size() == 1 ? bases.front() : union_basis(std::move(name), bases);
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

}  // namespace

Eigen::VectorXd reweighed(const Eigen::VectorXd& weights, const Eigen::VectorXd& log_scores,
                          const ModelAverageSettings& settings) {
  if (weights.size() != log_scores.size() || weights.size() == 0) {
    throw std::invalid_argument("each model needs a weight and a log score, got " + std::to_string(weights.size()) +
                                " weights and " + std::to_string(log_scores.size()) + " scores");
  }
  const double equal = 1.0 / static_cast<double>(weights.size());
  // Shared before the segment speaks, not after: what is spread to models that it refutes never reaches a prediction.
  const Eigen::ArrayXd shared = (1.0 - settings.share) * weights.array() + settings.share * equal;
  const Eigen::ArrayXd tempered = settings.learning_rate * (log_scores.array() - log_scores.maxCoeff());
  const Eigen::VectorXd heavier = shared * tempered.exp();
  return heavier / heavier.sum();
}

ModelAverage::ModelAverage(std::string name, const std::vector<Basis>& bases, ChainParameters learned,
                           const CausalFilterSettings& filter, const ModelAverageSettings& settings)
    : model_(averaged_basis(std::move(name), bases), learned),
      settings_(settings),
      weights_(
          Eigen::VectorXd::Constant(static_cast<Eigen::Index>(bases.size()), 1.0 / static_cast<double>(bases.size()))) {
  for (const Basis& basis : bases) {
    filters_.emplace_back(MotionModel(basis, learned), filter);
    places_.push_back(places_of(filters_.back().model(), model_));
  }
}

IekfUpdate ModelAverage::learn(const InputTrack& inputs, const Segment& segment) {
  speeds_.see(inputs, segment);
  std::vector<IekfUpdate> updates;
  for (CausalFilter& filter : filters_) {
    updates.push_back(filter.learn(inputs, segment, speeds_.reference()));
  }
  Eigen::Index heaviest = 0;
  weights_.maxCoeff(&heaviest);
  weights_ = reweighed(weights_, log_scores(updates), settings_);
  return updates[static_cast<std::size_t>(heaviest)];
}

/// All under one covariance, the models' mean: a model is judged by its errors, not by how well it knows their size.
Eigen::VectorXd ModelAverage::log_scores(const std::vector<IekfUpdate>& updates) const {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < updates.size(); ++i) {
    covariance += weights_[static_cast<Eigen::Index>(i)] * updates[i].innovation_covariance;
  }
  const Eigen::LLT<Eigen::Matrix3d> factor(covariance);
  Eigen::VectorXd scores(weights_.size());
  for (std::size_t i = 0; i < updates.size(); ++i) {
    const Eigen::Vector3d& innovation = updates[i].innovation;
    scores[static_cast<Eigen::Index>(i)] = student_log_score(innovation.dot(factor.solve(innovation)), covariance);
  }
  return scores;
}

AverageState ModelAverage::state() const {
  const Eigen::Index size = model_.size();
  AverageState state{{Eigen::VectorXd::Zero(size), Eigen::MatrixXd::Zero(size, size)},
                     Eigen::VectorXd::Zero(size),
                     variance_ratio(),
                     Eigen::Vector3d::Zero(),
                     weights_};
  for (std::size_t i = 0; i < filters_.size(); ++i) {
    const double weight = weights_[static_cast<Eigen::Index>(i)];
    state.noise_scale += weight * filters_[i].noise_scale();
    if (places_[i].empty()) {
      continue;  // the plain model: it has no parameters, and adds nothing to any mean
    }
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(size);
    mean(places_[i]) = filters_[i].estimate().mean;
    state.estimate.mean += weight * mean;
    state.estimate.covariance(places_[i], places_[i]) += weight * filters_[i].estimate().covariance;
    state.estimate.covariance += weight * mean * mean.transpose();
    state.prior_std(places_[i]) = filters_[i].prior_std();
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
    if (places_[i].empty()) {
      continue;
    }
    const double weight = weights_[static_cast<Eigen::Index>(i)];
    const Estimate& estimate = filters_[i].estimate();
    having(places_[i]).array() += weight;
    mean(places_[i]) += weight * estimate.mean;
    square(places_[i]) += weight * (estimate.covariance.diagonal() + estimate.mean.cwiseAbs2());
    prior(places_[i]) = filters_[i].prior_std().cwiseAbs2();
  }
  const Eigen::VectorXd variance = square.cwiseQuotient(having) - mean.cwiseQuotient(having).cwiseAbs2();
  return variance.cwiseQuotient(prior);
}

}  // namespace slipwise
