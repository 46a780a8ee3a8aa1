// SPDX-License-Identifier: Apache-2.0
// One lane of the drive over a window of wheel speeds: what is known of it at first, and how its means and its end
// follow from the chain and from its state at the start (derivations.md, section 4).
#pragma once

#include <Eigen/Core>
#include <optional>

#include "slipwise/actuator/axis_motion.hpp"
#include "slipwise/estimate/drive_noise.hpp"
#include "slipwise/estimate/wheel_means.hpp"

namespace slipwise {

/// Log lag, log delay [ln s], gain, slow share [-], log slow lag [ln s].
inline constexpr int kChannelParameters = 5;
/// Fast part, slow part, deviation from the chain.
inline constexpr int kLaneStates = 3;

using ChannelParameters = Eigen::Matrix<double, kChannelParameters, 1>;
using LaneVector = Eigen::Matrix<double, kLaneStates, 1>;

/// A window of wheel speeds and the inputs that they follow.
struct ChannelWindow {
  InputTrack inputs;
  WheelMeans seen;
};

/// The lane that follows this part of the inputs through a channel's parameters.
ActuatorAxis lane_of(double BodyTwist::* part, const ChannelParameters& parameters);

/// A lane's state and the variances of its parts.
struct FirstLaneState {
  LaneVector mean, variance;
};

/// Of a lane that was not followed until the window only the range of its speeds is known; none where it does not move.
/// `wander` is the variance of its deviation.
std::optional<FirstLaneState> first_state(const ChannelWindow& window, const ActuatorAxis& lane, double wander);

/// The lane through the window from the fast and the slow part at its start; derivatives by lags and delay are by their
/// logarithms, as the channel's parameters are.
AxisMotion lane_through(const ChannelWindow& window, const ActuatorAxis& lane, const AxisState& start);

/// The K means of the window, and after them the state at its end.
struct LanePassage {
  Eigen::VectorXd value;                                               ///< [K + 3]
  Eigen::Matrix<double, Eigen::Dynamic, kChannelParameters> by_chain;  ///< [K + 3, 5] by the channel's parameters
  Eigen::Matrix<double, Eigen::Dynamic, kLaneStates> by_state;         ///< [K + 3, 3] by the state at the start
};

LanePassage lane_passage(const ChannelWindow& window, const ActuatorAxis& lane, const LaneVector& start,
                         const DriveNoiseMeans& noise);

/// What wheel speeds say of the lane, [K].
Eigen::VectorXd lane_means(const WheelMeans& seen, const ActuatorAxis& lane);

}  // namespace slipwise
