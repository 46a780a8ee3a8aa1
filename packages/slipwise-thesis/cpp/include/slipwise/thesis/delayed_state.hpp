// SPDX-License-Identifier: Apache-2.0
// Pose filter whose state carries the slip parameters and a clone of an earlier pose (stochastic cloning).
#pragma once

#include <Eigen/Core>
#include <optional>

#include "slipwise/thesis/estimator_settings.hpp"

namespace slipwise {

/// State [p; X_now; X_delayed] (derivations/thesis.md). Every measured pose is used once, with its own noise, so
/// that neighbouring segments may share poses and nothing is counted twice. The parameters are learned through their
/// covariance with the predicted pose.
class DelayedState {
 public:
  /// Where the pose is predicted to, and the robot's state at the start, as in Segment.
  struct Leg {
    double end;                             ///< [s]
    std::optional<BodyTwist> initial = {};  ///< the drive's measured twist at the start of the leg
    double gx = 0.0;                        ///< [m/s^2]
    double gy = 0.0;                        ///< [m/s^2]
  };

  DelayedState(MotionModel model, const Estimate& prior, const EstimatorSettings& settings);

  /// X_now = a measured pose, with its noise; what was known of earlier poses is dropped.
  void start(double time, const Pose2& measured);
  /// Predicts X_now to the end of the leg with slip noise.
  void advance(const InputHistory& inputs, const Leg& leg);
  /// X_delayed = X_now. A pose measured now may then arrive late.
  void clone();
  /// Takes in the pose measured when clone() was called.
  void correct_delayed(const Pose2& measured);
  /// Takes in a pose measured now.
  void correct(const Pose2& measured);

  /// The same by segments: one that begins where the last ended shares its pose; any other begins again. Predicts from
  /// the clone at the start, linearised again where the update settles. The innovation is that of the pose at the end.
  IekfUpdate learn(const InputHistory& inputs, const Segment& segment);

  const MotionModel& model() const { return model_; }
  Estimate estimate() const;                            ///< of the parameters
  const Estimate& joint() const { return joint_; }      ///< [p; X_now; X_delayed]
  Pose2 pose() const { return at_row(model_.size()); }  ///< X_now
  /// The same data under another slip prior; false, and nothing done, where the posterior is too ill-conditioned.
  bool change_prior(const Eigen::VectorXd& old_std, const Eigen::VectorXd& new_std);
  /// Factor of the noise variances of (x, y, theta).
  void scale_noise(const Eigen::Vector3d& scale) { scale_ = scale; }

 private:
  struct Point {
    Eigen::VectorXd parameters;
    Pose2 pose;
  };

  Pose2 at_row(Eigen::Index row) const { return Pose2::from_vector(joint_.mean.segment<3>(row)); }
  Eigen::Matrix3d pose_noise() const;
  void advance_at(const Point& point, const InputHistory& inputs, const Leg& leg, double inflation);
  void update(Eigen::Index row, const Pose2& measured, const Eigen::Matrix3d& noise);
  IekfUpdate judge(const Pose2& end) const;
  Eigen::VectorXd settled(const InputHistory& inputs, const Segment& segment, const Pose2& end) const;
  void learn_weighted(const InputHistory& inputs, const Segment& segment, const Pose2& end, double weight);

  MotionModel model_;
  MotionNoise noise_;
  IekfSettings iekf_;
  int iterations_;
  Estimate joint_;
  Eigen::Vector3d scale_ = Eigen::Vector3d::Ones();
  double time_ = 0.0;    ///< of X_now
  Pose2 measured_ = {};  ///< the last measured pose
  bool started_ = false;
};

}  // namespace slipwise
