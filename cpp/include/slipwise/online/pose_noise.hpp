// SPDX-License-Identifier: Apache-2.0
// How much poses scatter from one to the next, learned from what they say of the motion between them.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "slipwise/online/pose_accuracy.hpp"
#include "slipwise/segment/segment.hpp"

namespace slipwise {

/// An error of one pose makes the motion before it too long and the one after it too short: neighbours' errors of
/// motion are opposite by as much as poses scatter, whatever the motion itself adds.
class PoseNoise {
 public:
  /// Begins with what is stated of the poses, or with the nominal where nothing is.
  explicit PoseNoise(const PoseStd& first);

  /// Takes in the motion between two poses that follow each other, measured minus expected, in the robot's axes.
  /// `ratio` is how exact the second of them is said to be beside others.
  void learn(const Eigen::Vector3d& error, const PoseStdRatio& ratio);
  /// The next motion does not follow the last.
  void pause() { last_.reset(); }

  /// Variances of a pose of that ratio (x, y [m^2], yaw [rad^2]).
  Eigen::Vector3d variances(const PoseStdRatio& ratio) const;

 private:
  Eigen::Vector2d variance_;  ///< per axis, of the heading
  Eigen::Vector2d least_;
  Eigen::Vector3d mean_;  ///< of the errors: what the model gets wrong always
  std::optional<Eigen::Vector3d> last_;
  PoseStdRatio last_ratio_;
  double count_ = 0.0;
};

}  // namespace slipwise
