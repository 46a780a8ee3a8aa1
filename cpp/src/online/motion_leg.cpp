// SPDX-License-Identifier: Apache-2.0
// Linearised about the learned mean and the slip disturbance of the moment.
#include "slipwise/online/motion_leg.hpp"

#include <algorithm>
#include <cmath>

#include "slipwise/actuator/axis_response.hpp"
#include "slipwise/segment/integrate_segment.hpp"
#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise {
namespace {

constexpr double kSpareMemory = 0.1;  // [s] for what parameters may still change

}  // namespace

Eigen::Matrix3d MotionLeg::covariance() const { return spread * by_lasting.transpose() + white; }

MotionLeg motion_leg(const LegKnowledge& known, const DrivenSegment& driven) {
  const MotionPosterior& posterior = *known.posterior;
  const ExpectedDeviation deviation =
      known.disturbance->deviation(posterior, known.slip, {driven.segment.start, driven.segment.end});
  const bool disturbed = deviation.covariance.size() > 0 && !known.slip.of_candidates.empty();
  Eigen::VectorXd mean = posterior.estimate.mean;
  Eigen::MatrixXd covariance = posterior.estimate.covariance;
  if (disturbed) {
    mean(deviation.places) += deviation.mean;
    covariance(deviation.places, deviation.places) += deviation.covariance;
  }
  const auto at = linearize_segment(posterior.model, mean, driven.inputs, driven.segment);
  const Eigen::Index size = mean.size();
  LastingColumns by_lasting(3, size + 3);
  by_lasting.leftCols(size) = at.by_parameter;
  const Eigen::Vector3d root = (known.inflation * posterior.noise_scale).cwiseSqrt();
  by_lasting.rightCols<3>() = root.asDiagonal() * constant_slip(at.path, posterior.noise);
  LastingColumns spread(3, size + 3);
  spread.leftCols(size) = known.inflation * at.by_parameter * covariance;
  spread.rightCols<3>() = by_lasting.rightCols<3>();
  MotionNoise white = posterior.noise;
  white.fraction = {};
  return {
      .motion = at.pose(),
      .spread = std::move(spread),
      .by_lasting = std::move(by_lasting),
      .white = root.asDiagonal() * Eigen::Matrix3d(slip_covariance(at.path, white)) * root.asDiagonal(),
      .posterior = known.posterior,
      .inputs_until = std::max(driven.segment.start, driven.segment.end - posterior.model.actuator(mean).clock_offset),
      .sensor = at.path.sensor()};
}

double leg_memory(const MotionPosterior& posterior) {
  const ActuatorModel actuator = posterior.model.actuator(posterior.estimate.mean);
  const double lag = std::max({actuator.time_constant_v, actuator.time_constant_omega, actuator.slow_time_constant_v,
                               actuator.slow_time_constant_omega});
  return kSettledLags * lag + std::max(actuator.delay_v, actuator.delay_omega) + std::abs(actuator.clock_offset) +
         kSpareMemory;
}

}  // namespace slipwise
