// SPDX-License-Identifier: Apache-2.0
// What is not known of a model, checked and as kernels take it.
#include "slipwise/rollout/path_noise.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace slipwise {

void check_uncertainty(const UncertainModel& model) {
  const ModelUncertainty& uncertainty = model.uncertainty;
  const Eigen::Index parameters = model.model.size();
  const auto& covariance = uncertainty.covariance;
  if (covariance.rows() != parameters || covariance.cols() != parameters) {
    throw std::invalid_argument("the covariance is " + std::to_string(covariance.rows()) + " by " +
                                std::to_string(covariance.cols()) + " for " + std::to_string(parameters) +
                                " parameters");
  }
  if (!covariance.allFinite() || !uncertainty.scale.allFinite() || (uncertainty.scale.array() < 0.0).any() ||
      !(uncertainty.inflation >= 0.0) || !std::isfinite(uncertainty.inflation)) {
    throw std::invalid_argument("the covariance, its scale and its inflation must be finite, and no scale negative");
  }
  check_disturbance(uncertainty.disturbance);
  const auto stretches = std::ssize(model.setting.ahead.edges) + 1;
  for (const Eigen::MatrixXd& direction : uncertainty.ahead) {
    if (direction.rows() != model.model.slip_size() || direction.cols() != stretches || !direction.allFinite()) {
      throw std::invalid_argument("what is not known of the slip ahead has other terms or stretches than the slip");
    }
  }
}

DisturbedTerms disturbed_terms_of(const UncertainModel& model) {
  const ModelUncertainty& uncertainty = model.uncertainty;
  return uncertainty.disturbance.candidates.empty() ? DisturbedTerms{}
                                                    : disturbed_terms(model.model, uncertainty.prior_std);
}

RolloutProgram moved(const UncertainModel& model, Eigen::VectorXd parameters, const Eigen::MatrixXd& ahead) {
  RolloutSetting setting = model.setting;
  move_slip(ahead, parameters, setting.ahead);
  return {model.model, parameters, setting};
}

template <typename Scalar>
LaneNoise<Scalar> lane_noise(const MotionNoise& noise, const Eigen::Vector3d& widened) {
  const auto number = [](double value) { return static_cast<Scalar>(value); };
  LaneNoise<Scalar> lanes{.psd_time = {},
                          .psd_motion = {},
                          .fraction = {},
                          .turn_radius = number(kTurnRadius),
                          .per_straight_radius = number(1.0 / kStraightRadius)};
  for (std::size_t c = 0; c < noise.fraction.size(); ++c) {
    const double variance = widened[static_cast<Eigen::Index>(c)];
    lanes.psd_time[c] = number(variance * noise.psd_time[c]);
    lanes.psd_motion[c] = number(variance * noise.psd_motion[c]);
    lanes.fraction[c] = number(std::sqrt(variance) * noise.fraction[c]);
  }
  return lanes;
}

template LaneNoise<float> lane_noise<float>(const MotionNoise&, const Eigen::Vector3d&);
template LaneNoise<double> lane_noise<double>(const MotionNoise&, const Eigen::Vector3d&);

}  // namespace slipwise
