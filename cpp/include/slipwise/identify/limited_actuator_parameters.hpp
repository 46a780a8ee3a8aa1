// SPDX-License-Identifier: Apache-2.0
// The smooth parameters of a limited drive in a row, on a logarithmic scale where positive, and their prior.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slipwise/identify/limited_actuator_fit.hpp"

namespace slipwise {

/// In a row: gain, log lag and log delay per channel, log separation, and per axis log saturation and
/// slew rates.
inline constexpr int kFirstLag = 2;  ///< of the speed, and behind it that of the yaw rate
inline constexpr int kActuatorPart = 6;
inline constexpr int kSeparationPlace = 6;
inline constexpr int kFirstLimit = 7;
inline constexpr int kLimitsPerAxis = 3;  ///< dead-bands are no smooth parameters
using LimitParameters = Eigen::Matrix<double, kFirstLimit + 3 * kLimitsPerAxis, 1>;

LimitParameters parameters_of(const LimitedActuator& drive);
/// The sides' dead-band stays between the commands that it stood between.
LimitedActuator with_parameters(LimitedActuator drive, const LimitParameters& p);
/// The places of the parameters that do anything.
std::vector<int> free_parameters(const LimitedActuator& drive);

/// Whether a parameter is the lag of a channel.
bool is_lag(int parameter);
/// Whether a parameter leaves the limited commands as they are.
bool acts_behind(int parameter, const LimitedActuator& drive);
/// Whether a parameter has an effect on the speed (channel 0) or on the yaw rate (channel 1) of the drive.
bool acts_on(int parameter, const LimitedActuator& drive, int channel);

inline constexpr double kSeparationLogStd = 0.5;  ///< of the separation of the sides about the one given

/// Prior precision of a parameter, and how far it lies from its prior mean.
struct PriorPull {
  double precision, gap;
};
PriorPull prior_pull(int parameter, const LimitParameters& p, const PriorSettings& prior, double wheel_separation);

}  // namespace slipwise
