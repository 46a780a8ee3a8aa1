// SPDX-License-Identifier: Apache-2.0
// Rollouts of a car commanded by throttle and steering: what its curves make of each command, for a rollout of twists
// (derivations/sensors.md).
#pragma once

#include <vector>

#include "slipwise/actuator/car_curves.hpp"
#include "slipwise/rollout/rollout_batch.hpp"

namespace slipwise {

/// Mean twists in place of commands.
template <typename Scalar>
struct CarBatch {
  std::vector<Scalar> v;           ///< [periods * rollouts] [m/s], rollouts side by side
  std::vector<Scalar> omega;       ///< [rad/s]
  std::vector<DriveCommand> past;  ///< of each start
};

/// What a car does over each period of a batch whose commands are throttle (v) and steering (omega), those of the past
/// too. A start's drive is what it does then (v, omega). Its steering has followed the past; without any, it stands
/// where the drive's yaw rate asks for it. Over the past, the speed is taken as that of the start, and commands that
/// have not reached the car by then act after it; where the past is too short to tell them, it goes on as it does.
/// \throws std::invalid_argument where starts and past do not fit, a command is not finite, the car's delay is negative
/// or longer than a minute, or the processor lacks the instruction level.
template <typename Scalar>
CarBatch<Scalar> car_batch(const CarCurves& car, const RolloutBatch<Scalar>& batch, double period,
                           const RolloutOptions& options = {});

extern template CarBatch<float> car_batch(const CarCurves&, const RolloutBatch<float>&, double, const RolloutOptions&);
extern template CarBatch<double> car_batch(const CarCurves&, const RolloutBatch<double>&, double,
                                           const RolloutOptions&);

}  // namespace slipwise
