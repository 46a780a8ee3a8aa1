// SPDX-License-Identifier: Apache-2.0
// Slip noise of one period, and the paths that it acts on.
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

RolloutProgram drive_alone(const UncertainModel& model) {
  Eigen::VectorXd parameters = model.parameters;
  parameters.head(model.model.slip_size()).setZero();
  RolloutSetting setting = model.setting;
  setting.ahead = {};
  return {model.model, parameters, setting};
}

RolloutProgram moved(const UncertainModel& model, Eigen::VectorXd parameters, const Eigen::MatrixXd& ahead) {
  RolloutSetting setting = model.setting;
  move_slip(ahead, parameters, setting.ahead);
  return {model.model, parameters, setting};
}

RolloutPaths roll_paths(const RolloutProgram& program, const RolloutBatch<double>& batch,
                        const RolloutOptions& options) {
  const std::size_t poses = batch.rollouts * batch.periods;
  RolloutPaths paths{batch.rollouts, batch.periods, std::vector<double>(poses), std::vector<double>(poses),
                     std::vector<double>(poses)};
  RolloutOutputs<double> outputs;
  outputs.x = paths.x.data();
  outputs.y = paths.y.data();
  outputs.theta = paths.theta.data();
  rollout_batch(program, batch, outputs, options);
  return paths;
}

Eigen::Vector3d period_tangent(const Pose2& before, const Pose2& after) {
  const Pose2 moved = between(before, after);
  const auto arc = arc_functions(moved.theta);
  const double scale = 1.0 / (arc.a * arc.a + arc.b * arc.b);
  return {scale * (arc.a * moved.x + arc.b * moved.y), scale * (arc.a * moved.y - arc.b * moved.x), moved.theta};
}

PeriodNoise period_noise(const Eigen::Vector3d& drive, double period, const MotionNoise& noise) {
  const double distance = std::hypot(drive.x(), drive.y());
  const double turn = std::abs(drive.z());
  const double wheels = distance + kTurnRadius * turn;
  const std::array<double, 3> motion{wheels, wheels, turn + distance / kStraightRadius};
  const double moving_time = wheels > 0.0 ? period : 0.0;
  PeriodNoise result{};
  for (std::size_t c = 0; c < motion.size(); ++c) {
    result.variance[c] = noise.psd_time[c] * moving_time + noise.psd_motion[c] * motion[c];
    result.constant[c] = noise.fraction[c] * motion[c];
  }
  return result;
}

}  // namespace slipwise
