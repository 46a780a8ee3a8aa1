// SPDX-License-Identifier: Apache-2.0
// Priors in physical units: what fraction of the motion a term may explain, and plausible lags, delays, offsets and
// sensor extrinsics.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "slipwise/filter/estimate.hpp"
#include "slipwise/motion/motion_model.hpp"

namespace slipwise {

/// Speeds that the robot drives at; they give the priors their units.
struct ReferenceSpeeds {
  double v;      ///< [m/s]
  double omega;  ///< [rad/s]
};

struct PriorSettings {
  double slip_fraction = 0.3;  ///< standard deviation of a term's slip as a fraction of the commanded twist [-]
  /// Of the side-slip angle of a robot that drives straight [rad]; without it, slip_fraction alone holds. Positions do
  /// not tell it from the heading.
  std::optional<double> straight_side_slip_std = {};
  double clock_offset_std = 0.2;    ///< about 0, also of delays without an actuator model [s]
  double time_constant = 0.3;       ///< median time constant [s]
  double delay = 0.1;               ///< median transport delay [s]
  double log_std = 0.8;             ///< standard deviation of the logarithms of lags and delays [-]
  double body_lag = 0.018;          ///< median time constant of a body behind its wheels [s]
  double body_lag_log_std = 1.0;    ///< standard deviation of its logarithm [-]
  double gain_std = 0.2;            ///< of the drive over the input, about 1 [-]
  double slow_fraction_std = 0.3;   ///< of the fraction of the drive that follows slowly, about 0 [-]
  double slow_time_constant = 2.0;  ///< median slow time constant [s]
  Pose2 sensor = {};                ///< where the pose sensor is thought to sit in base_link
  double extrinsics_std = 1.0;      ///< of its x and y about that [m]
  double sensor_yaw_std = 0.1;      ///< of its yaw about that [rad]
};

/// Standard deviation of each slip parameter: fraction * reference of its channel / |term at the reference speeds|.
Eigen::VectorXd slip_prior_std(const Basis& basis, const ReferenceSpeeds& speeds, double fraction);
/// The same by all that settings say of slip.
Eigen::VectorXd slip_prior_std(const Basis& basis, const ReferenceSpeeds& speeds, const PriorSettings& settings);
/// The posterior before any data.
Estimate prior_estimate(const MotionModel& model, const ReferenceSpeeds& speeds, const PriorSettings& settings);
/// The same data under a slip prior of other standard deviations (exact for the Gaussian posterior; the prior mean is
/// zero). Nothing when the posterior is too ill-conditioned for it.
std::optional<Estimate> change_slip_prior(const Estimate& estimate, const Eigen::VectorXd& old_std,
                                          const Eigen::VectorXd& new_std);

}  // namespace slipwise
