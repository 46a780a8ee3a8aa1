// SPDX-License-Identifier: Apache-2.0
// The table of estimators.
#include "slipwise/thesis/estimator.hpp"

#include <array>
#include <stdexcept>

namespace slipwise {
namespace {

using Make = Estimator (*)(const MotionModel&, const Estimate&, const EstimatorSettings&);

template <SegmentEstimator T>
Estimator make(const MotionModel& model, const Estimate& prior, const EstimatorSettings& settings) {
  return Estimator(T(model, prior, settings));
}

struct Entry {
  std::string_view name;
  bool overlapping;
  Make make;
};

constexpr std::array<Entry, 5> kEstimators{{{"gradient-descent", true, make<GradientDescent>},
                                            {"ekf-thesis", true, make<EkfThesis>},
                                            {"iekf", false, make<IekfEstimator>},
                                            {"delayed-state", false, make<DelayedState>},
                                            {"batch", false, make<BatchEstimator>}}};

const Entry& entry_of(std::string_view name) {
  std::string known;
  for (const Entry& entry : kEstimators) {
    if (entry.name == name) {
      return entry;
    }
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw std::invalid_argument("unknown estimator '" + std::string(name) + "'; known are " + known);
}

}  // namespace

std::vector<std::string> estimator_names() {
  std::vector<std::string> names;
  for (const Entry& entry : kEstimators) {
    names.emplace_back(entry.name);
  }
  return names;
}

bool learns_overlapping_segments(std::string_view name) { return entry_of(name).overlapping; }

Estimator make_estimator(std::string_view name, const MotionModel& model, const Estimate& prior,
                         const EstimatorSettings& settings) {
  const Entry& entry = entry_of(name);
  model.check(prior.mean);
  if (prior.covariance.rows() != model.size() || prior.covariance.cols() != model.size()) {
    throw std::invalid_argument("the prior's covariance must have one row and column per parameter, " +
                                std::to_string(model.size()));
  }
  return entry.make(model, prior, settings);
}

}  // namespace slipwise
