// SPDX-License-Identifier: Apache-2.0
// Dead-bands: no slope leads to one, so that each is placed between two commands, by trying.
#pragma once

#include <Eigen/Core>
#include <span>

#include "slipwise/estimate/limited_drive_fit.hpp"

namespace slipwise {

class DeadBandSearch {
 public:
  DeadBandSearch(std::span<const DriveRecord> records, const LimitedDriveFit& fit) : records_(records), fit_(fit) {}

  /// The drive with each of its dead-bands between the commands that explain most; the rest is held.
  ScoredDrive best(ScoredDrive drive) const;
  /// The drive with the commands that its sides' dead-band lies between remembered.
  LimitedDrive between_commands(LimitedDrive drive) const;
  /// Dead-bands between two neighbouring commands are all alike, and nearly so beyond them: half that width as of a
  /// uniform distribution. What those commands ask of the sides is not known exactly either; `to_sides` is of
  /// LimitedDriveFit::Spread.
  double std(const ScoredDrive& drive, LimitedAxis lane, const Eigen::Matrix3d& to_sides) const;

 private:
  ScoredDrive best(const ScoredDrive& drive, LimitedAxis lane) const;
  double side_std(const CommandLimits& limits, double lower, double upper, const Eigen::Matrix3d& to_sides) const;

  std::span<const DriveRecord> records_;
  const LimitedDriveFit& fit_;
};

}  // namespace slipwise
