// SPDX-License-Identifier: Apache-2.0
// The posterior of a motion model at one time: its parameters, how sure they are, and the noise around it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "slipwise/filter/estimate.hpp"
#include "slipwise/motion/motion_model.hpp"
#include "slipwise/motion/motion_noise.hpp"

namespace slipwise {

/// How motion is explained.
enum class Structure : std::uint8_t {
  Joint,     ///< slip and actuator learned from poses alone
  Cascaded,  ///< the actuator learned from wheel speeds, the slip behind it from poses
  Limited,   ///< one of these behind dead band, saturation and slew rates
  Direct,    ///< slip and delays: no lag
  Baseline   ///< the kinematic baseline: the robot does at once what it is commanded
};
inline constexpr std::size_t kStructures = 5;
constexpr std::size_t enumerators(Structure /*type*/) { return kStructures; }

/// Posterior over prior variance, above which a parameter counts as not identifiable.
inline constexpr double kUnidentifiableRatio = 0.5;

struct MotionPosterior {
  MotionModel model;
  Estimate estimate;
  Eigen::VectorXd prior_std;            ///< [parameters]
  MotionNoise noise;                    ///< model of the noise,
  Eigen::Vector3d noise_scale;          ///< and the learned factor of its variances
  Eigen::VectorXd variance_ratio = {};  ///< [parameters] posterior over prior variance
  Eigen::VectorXd basis_weights = {};   ///< of the bases that are averaged
  Structure structure = Structure::Joint;
};

}  // namespace slipwise
