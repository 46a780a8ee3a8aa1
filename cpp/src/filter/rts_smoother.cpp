// SPDX-License-Identifier: Apache-2.0
// Rauch, Tung and Striebel 1965 over iterated forward updates.
#include "slipwise/filter/rts_smoother.hpp"

#include <cmath>
#include <stdexcept>

#include "slipwise/linear/cholesky.hpp"
#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise {
namespace {

double kept(double distance, const DriftSettings& settings) {
  return settings.drift == Drift::RandomWalk ? 1.0 : std::exp(-distance / settings.length);
}

/// Wheel travel of a segment's inputs [m].
double travel(const BatchDatum& datum) {
  double sum = 0.0;
  const ActuatorSpan window{.start = datum.segment.start, .end = datum.segment.end};
  for (const ActuatorStep& step : actuator_steps(datum.inputs, {}, window).steps) {
    sum += std::hypot(step.forward, step.left) + kTurnRadius * std::abs(step.turn);
  }
  return sum;
}

}  // namespace

Estimate drifted(const Estimate& estimate, const Estimate& prior, double distance, const DriftSettings& settings) {
  const double a = kept(distance, settings);
  const double added = settings.drift == Drift::RandomWalk ? distance / settings.length : 1.0 - a * a;
  return {prior.mean + a * (estimate.mean - prior.mean), a * a * estimate.covariance + added * prior.covariance};
}

std::vector<Estimate> rts_smooth(const MotionModel& model, const Estimate& prior, std::span<const BatchDatum> data,
                                 const DriftSettings& drift, const IekfSettings& iekf) {
  if (data.empty() || !(drift.length > 0.0)) {
    throw std::invalid_argument("smoothing needs at least one segment and a positive drift length");
  }
  std::vector<Estimate> predicted, smoothed;
  std::vector<double> distances;
  for (const BatchDatum& datum : data) {  // forward: drift over the last segment's travel, then learn
    predicted.push_back(smoothed.empty() ? prior : drifted(smoothed.back(), prior, distances.back(), drift));
    const IekfUpdate update = iekf_update(model, predicted.back(), datum.inputs, datum.segment, datum.noise, iekf);
    smoothed.push_back(update.estimate);
    distances.push_back(travel(datum));
  }
  for (std::size_t k = data.size() - 1; k-- > 0;) {  // backward: C = P_k a P_{k+1|k}^-1
    const double a = kept(distances[k], drift);
    const Eigen::MatrixXd gain =
        a * solve_symmetric_columns(predicted[k + 1].covariance, smoothed[k].covariance).transpose();
    smoothed[k].mean += gain * (smoothed[k + 1].mean - predicted[k + 1].mean);
    const Eigen::MatrixXd change = smoothed[k + 1].covariance - predicted[k + 1].covariance;
    smoothed[k].covariance += gain * change * gain.transpose();
  }
  return smoothed;
}

}  // namespace slipwise
