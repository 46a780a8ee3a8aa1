// SPDX-License-Identifier: Apache-2.0
// What one lane of the drive does from a known state on, with exact derivatives (derivations.md, section 4).
#pragma once

#include <Eigen/Core>
#include <span>

#include "slipwise/actuator/channel_response.hpp"
#include "slipwise/actuator/input_track.hpp"

namespace slipwise {

/// One lane: which part of the inputs it follows, and how.
struct ActuatorAxis {
  double BodyTwist::* part;
  ChannelResponse response;
  double delay;  ///< [s]
};

/// What the two lags of a lane hold; its speed is their sum [m/s or rad/s].
struct LaneState {
  double fast, slow;
};

/// Derivatives are by lag, delay [s], gain, slow share [-], slow lag [s], and by the fast and the slow state at the
/// start.
inline constexpr int kLaneParameters = 7;

struct LaneMotion {
  Eigen::VectorXd value;  ///< [K + 2] mean over each interval, then the state at the end
  Eigen::Matrix<double, Eigen::Dynamic, kLaneParameters> slope;  ///< [K + 2, 7]
};

/// The state of a lane whose input at `time` [s] was held for long.
LaneState settled_lane(const InputTrack& inputs, const ActuatorAxis& lane, double time);

/// The lane over the K intervals between `edges` [s, increasing, in input stamps], from `start` at the first of them.
LaneMotion lane_motion(const InputTrack& inputs, const ActuatorAxis& lane, const LaneState& start,
                       std::span<const double> edges);

/// Its values alone.
Eigen::VectorXd lane_values(const InputTrack& inputs, const ActuatorAxis& lane, const LaneState& start,
                            std::span<const double> edges);

}  // namespace slipwise
