// SPDX-License-Identifier: Apache-2.0
// The motion model: a slip basis behind a command actuator, observed by a pose sensor, and the layout of its parameter
// vector.
#pragma once

#include <Eigen/Core>
#include <tuple>
#include <utility>
#include <vector>

#include "slipwise/actuator/actuator_model.hpp"
#include "slipwise/lie/se2.hpp"
#include "slipwise/motion/parameter_block.hpp"
#include "slipwise/slip/basis.hpp"

namespace slipwise {

/// Which parts of the actuator, and of what measures its poses, are parameters. What is not learned is the identity.
struct ActuatorParameters {
  bool dynamics = false;           ///< lag and delay per channel
  bool clock_offset = false;       ///< offset between inputs and poses
  bool response = false;           ///< gain, and a slow mode with its fraction and time constant, per channel
  bool sensor_extrinsics = false;  ///< where the pose sensor sits on the robot
  bool delays = false;             ///< delay per channel alone: no actuator model follows it
  bool lags = false;               ///< lag per channel alone: of a body behind its wheels
  /// Of a robot that steers, whose lags and delays act on the curvature of its path [m], which is no parameter; 0: on
  /// the yaw rate.
  double wheelbase = 0.0;
};

inline constexpr Eigen::Index kExtrinsicsParameters = 3;

/// Derivative, by its logarithm, of a coordinate of a time in which motion is nearly linear
/// (derivations/filter.md): (s + 0.03) / (s + 0.3) for s [s].
double log_time_derivative(double seconds);

/// Parameter vector: slip (basis order), then log time_constant_v, log time_constant_omega, log delay_v, log
/// delay_omega [ln s], then gain_v, gain_omega, slow_fraction_v, slow_fraction_omega [-], log slow_time_constant_v, log
/// slow_time_constant_omega [ln s], then clock offset [s], then sensor_x, sensor_y [m], sensor_yaw [rad]. Logarithms
/// keep lags and delays positive. Delays alone are delay_v, delay_omega [s] in place of the four logarithms: a robot
/// that obeys at once has none, which no logarithm reaches, and stamps may make them negative. Lags alone are the first
/// two logarithms.
class MotionModel {
 public:
  MotionModel();  ///< the kinematic baseline: no slip, nothing learned
  /// \throws std::invalid_argument when delays alone are wanted together with lags, gains or a slow mode, lags alone
  /// with delays, or the wheelbase is negative or not finite.
  MotionModel(Basis basis, ActuatorParameters learned);

  /// What the constructor takes.
  std::tuple<Basis, ActuatorParameters> definition() const { return {basis_, learned_}; }
  const Basis& basis() const { return basis_; }
  ActuatorParameters learned() const { return learned_; }
  Eigen::Index slip_size() const { return static_cast<Eigen::Index>(basis_.size()); }
  Eigen::Index actuator_size() const { return static_cast<Eigen::Index>(actuator_places_.size()); }
  Eigen::Index extrinsics_size() const { return learned_.sensor_extrinsics ? kExtrinsicsParameters : 0; }
  Eigen::Index size() const { return slip_size() + actuator_size() + extrinsics_size(); }
  std::vector<ParameterInfo> parameters() const;

  ActuatorModel actuator(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
  /// Pose of the sensor in base_link; the identity where it is not learned.
  Pose2 sensor_extrinsics(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
  /// Which of the actuator's parameters (in ActuatorModel's order) the model's actuator parameters are, one after the
  /// other.
  const std::vector<Eigen::Index>& actuator_places() const { return actuator_places_; }
  /// Derivative of each of those by the model's parameter: d exp(log s) / d log s = s, or 1.
  Eigen::VectorXd actuator_scales(const ActuatorModel& actuator) const;

  /// `log_time_derivative` of each time whose logarithm is learned, 1 for the other parameters.
  Eigen::VectorXd log_time_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;

  /// \throws std::invalid_argument when the length is not size() or a value is not finite.
  void check(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;

 private:
  Basis basis_;
  ActuatorParameters learned_;
  std::vector<Eigen::Index> actuator_rows_;  ///< in the table of what may be learned of the actuator
  std::vector<Eigen::Index> actuator_places_;
};

}  // namespace slipwise
