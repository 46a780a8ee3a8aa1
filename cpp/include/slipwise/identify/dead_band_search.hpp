// SPDX-License-Identifier: Apache-2.0
// Dead-bands: no derivative leads to one, so that each is placed between two commands, by trying.
#pragma once

#include <Eigen/Core>
#include <span>

#include "slipwise/identify/limited_actuator_fit.hpp"

namespace slipwise {

class DeadBandSearch {
 public:
  DeadBandSearch(std::span<const WheelRecord> records, const LimitedActuatorFit& fit) : records_(records), fit_(fit) {}

  /// The drive with each of its dead-bands between the commands that explain most; the rest is held.
  ScoredActuator best(ScoredActuator drive) const;
  /// The drive with the commands that its sides' dead-band lies between remembered.
  LimitedActuator between_commands(LimitedActuator drive) const;
  /// Dead-bands between two neighbouring commands are all alike, and nearly so beyond them: half that width as of a
  /// uniform distribution. What those commands ask of the sides is not known exactly either; `to_sides` is of
  /// LimitedActuatorFit::Spread.
  double std(const ScoredActuator& drive, LimitedAxis axis, const Eigen::Matrix3d& to_sides) const;

 private:
  ScoredActuator best(const ScoredActuator& drive, LimitedAxis axis) const;
  double side_std(const CommandLimits& limits, double lower, double upper, const Eigen::Matrix3d& to_sides) const;

  std::span<const WheelRecord> records_;
  const LimitedActuatorFit& fit_;
};

}  // namespace slipwise
