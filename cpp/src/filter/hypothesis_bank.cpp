// SPDX-License-Identifier: Apache-2.0
// Weights of hypotheses that come, learn and go.
#include "slipwise/filter/hypothesis_bank.hpp"

#include <cmath>
#include <numeric>
#include <stdexcept>

namespace slipwise {
namespace {

double sum_of(const Eigen::VectorXd& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

}  // namespace

std::size_t HypothesisWeights::heaviest() const {
  return static_cast<std::size_t>(std::ranges::max_element(weights_) - weights_.begin());
}

double HypothesisWeights::log_evidence() const {
  const double most = evidence_.maxCoeff();
  const Eigen::VectorXd odds = (evidence_.array() - most).exp();
  return most + std::log(sum_of(odds));
}

void HypothesisWeights::learn(const Eigen::VectorXd& log_scores, const WeightingSettings& settings) {
  weights_ = updated_weights(weights_, log_scores, prior_ / prior_.sum(), settings, observed_);
  evidence_ += settings.learning_rate * log_scores;
  ++observed_;
}

void HypothesisWeights::weigh(const Eigen::VectorXd& log_factors) {
  evidence_ += log_factors;
  const Eigen::ArrayXd odds = (evidence_.array() - evidence_.maxCoeff()).exp();
  weights_ = odds / odds.sum();
}

void HypothesisWeights::begin_with(Eigen::VectorXd weights, std::size_t observed) {
  weights_ = std::move(weights);
  observed_ = observed;
}

void HypothesisWeights::favour(std::size_t place, double weight) {
  const auto favoured = static_cast<Eigen::Index>(place);
  const double others = 1.0 - weights_[favoured];
  weights_ *= others > 0.0 ? (1.0 - weight) / others : 1.0;
  weights_[favoured] = others > 0.0 ? weight : 1.0;
  evidence_.setZero();
  evidence_[favoured] = std::log(weight / (1.0 - weight));
}

void HypothesisWeights::normalise() { weights_ /= sum_of(weights_); }

void HypothesisWeights::check_sizes(std::size_t count) const {
  const auto possible = [](double weight) { return weight >= 0.0 && weight <= 2.0; };
  if (std::cmp_not_equal(weights_.size(), count) || prior_.size() != weights_.size() ||
      evidence_.size() != weights_.size() || !std::ranges::all_of(weights_, possible) ||
      evidence_.array().isNaN().any()) {
    throw std::invalid_argument("the weights of hypotheses do not fit together");
  }
}

void HypothesisWeights::add(double weight, double prior, double evidence) {
  const Eigen::Index size = weights_.size();
  weights_.conservativeResize(size + 1);
  prior_.conservativeResize(size + 1);
  evidence_.conservativeResize(size + 1);
  weights_[size] = weight;
  prior_[size] = prior;
  evidence_[size] = evidence;
}

/// Others leave to one of this prior weight its part, which is returned.
double HypothesisWeights::room_for(double prior) {
  const double others = sum_of(prior_);
  const double whole = others + prior;
  weights_ *= others / whole / sum_of(weights_);
  return prior / whole;
}

void HypothesisWeights::choose(std::span<const std::size_t> places) {
  for (Eigen::VectorXd* values : {&weights_, &prior_, &evidence_}) {
    *values = Eigen::VectorXd((*values)(places));
  }
}

}  // namespace slipwise
