// SPDX-License-Identifier: Apache-2.0
// Hypotheses that explain the same measurements: what each of them is, and how probable.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "slipwise/filter/weighting.hpp"

namespace slipwise {

/// How probable each of some hypotheses is. They `learn` from measurement to measurement, with tempered Bayes and a
/// part of the weight that moves on (WeightingSettings), or `weigh`, with Bayes alone.
class HypothesisWeights {
 public:
  const Eigen::VectorXd& weights() const { return weights_; }
  const Eigen::VectorXd& prior() const { return prior_; }  ///< need not add up to 1
  /// Log scores so far, as far as they counted.
  const Eigen::VectorXd& evidence() const { return evidence_; }
  /// Measurements that weighted them.
  std::size_t observed() const { return observed_; }
  std::size_t heaviest() const;
  /// Logarithm of the mean likelihood, where evidence began with the logarithm of the prior weight.
  double log_evidence() const;

  /// One more measurement, with its log score under each.
  void learn(const Eigen::VectorXd& log_scores, const WeightingSettings& settings);
  /// One more measurement that says nothing of any.
  void pass() { ++observed_; }
  /// Adds log factors to the evidence, which alone makes the weights from now on.
  void weigh(const Eigen::VectorXd& log_factors);
  /// What was found elsewhere: weights that so many measurements made.
  void begin_with(Eigen::VectorXd weights, std::size_t observed);
  /// One has this weight, and all others the rest.
  void favour(std::size_t place, double weight);
  /// Divides the weights by their sum.
  void normalise();
  /// \throws std::invalid_argument unless so many have a weight, a prior weight and evidence that are possible.
  void check_sizes(std::size_t count) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.weights_, self.prior_, self.evidence_, self.observed_);
  }

 protected:
  void add(double weight, double prior, double evidence);
  void choose(std::span<const std::size_t> places);
  double room_for(double prior);

 private:
  Eigen::VectorXd weights_;
  Eigen::VectorXd prior_;
  Eigen::VectorXd evidence_;
  std::size_t observed_ = 0;
};

/// A key is what is weighted: its name, or a filter of its own.
template <class Key>
class HypothesisBank : public HypothesisWeights {
 public:
  std::size_t size() const { return keys_.size(); }
  const std::vector<Key>& keys() const { return keys_; }
  std::vector<Key>& keys() { return keys_; }
  const Key& operator[](std::size_t place) const { return keys_[place]; }
  Key& operator[](std::size_t place) { return keys_[place]; }
  /// Where it is; `size()` if it is not there.
  std::size_t place_of(const Key& key) const {
    return static_cast<std::size_t>(std::ranges::find(keys_, key) - keys_.begin());
  }

  /// One more, whose weight is its prior weight.
  void add(Key key, double prior, double evidence = 0.0) {
    keys_.push_back(std::move(key));
    HypothesisWeights::add(prior, prior, evidence);
  }
  /// One more, with the part of the weight that it would have had from the start.
  void join(Key key, double prior, double evidence) {
    keys_.push_back(std::move(key));
    HypothesisWeights::add(room_for(prior), prior, evidence);
  }
  /// Those at these places, in this order, with weights as they are; one that is named twice comes twice.
  HypothesisBank chosen(std::span<const std::size_t> places) const {
    HypothesisBank some;
    some.HypothesisWeights::operator=(*this);
    some.choose(places);
    some.keys_.reserve(places.size());
    std::ranges::for_each(places, [&](std::size_t place) { some.keys_.push_back(keys_[place]); });
    return some;
  }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.keys_);
    HypothesisWeights::archive(self, a);
    if constexpr (!std::is_const_v<Self>) {
      self.check_sizes(self.size());
    }
  }

 private:
  std::vector<Key> keys_;
};

}  // namespace slipwise
