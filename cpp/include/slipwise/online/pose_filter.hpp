// SPDX-License-Identifier: Apache-2.0
// Where the robot is: measured poses, and between them the learned motion (thesis 8.1.1).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <optional>

#include "slipwise/online/motion_leg.hpp"
#include "slipwise/online/pose_gate.hpp"
#include "slipwise/online/pose_noise.hpp"
#include "slipwise/online/segment_cutter.hpp"

namespace slipwise {

struct PoseFilterSettings {
  PoseStd nominal = {0.02, 0.01};  ///< of a pose that comes without standard deviations
  double late_factor = 2.5;        ///< a pose after a gap of more than this many median intervals is late
  double keep = 2.0;               ///< states of the last seconds are kept for measurements that come late [s]
};

/// Where the pose sensor is, and how sure that is.
struct SensorPose {
  double t;                    ///< [s]
  Pose2 pose;                  ///< in the frame of the measured poses
  Eigen::Matrix3d covariance;  ///< of (x, y, yaw) in the frame's axes
  long frame;                  ///< of the last pose used
  double since_pose;           ///< since that [s]
};

/// A Kalman filter over the pose of the sensor. The errors of the parameters are not estimated here, for the slip
/// filter learns them; how they hang together with the pose is followed (a Schmidt filter), so that they are not taken
/// for new ones at each step. States at the poses are kept: a measurement that comes late takes effect at its stamp,
/// and what follows is predicted again. Poses far from where the robot can be move nothing, unless three more agree
/// with the first of them. Nothing is computed until the first call; after ten seconds of poses
/// without a call the filter begins again within them.
class PoseFilter {
 public:
  /// Predicts the motion from a time to a later one [s].
  using Legs = std::function<MotionLeg(double start, double end)>;

  explicit PoseFilter(const PoseFilterSettings& settings);

  /// Another run begins.
  void restart();
  /// Takes a pose, whose stamp is later than those before.
  void push(const MeasuredPose& pose);
  /// An input came that is stamped `t` [s]: what was predicted without it is predicted again.
  void forget_without(double t);
  /// Where the sensor is at `t` [s], which is no earlier than any pose; nothing before the first pose.
  std::optional<SensorPose> at(double t, const Legs& legs);

 private:
  struct State {
    double t = 0.0;
    Pose2 pose = {};
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    LastingColumns with_lasting = {};  ///< covariance with the lasting errors
    std::shared_ptr<const MotionPosterior> posterior = {};
  };
  /// All that is known after a pose, or on the way to the next.
  struct Moment {
    State main;
    double inputs_until;         ///< later inputs change nothing of it [s]
    std::optional<State> other;  ///< where the robot is if poses that were rejected are right
    int agreed = 0;              ///< poses that say so too
    double misfit = 1.0;         ///< factor of the legs' covariance by which innovations are explained
    PoseNoise noise;
    State after_pose;                  ///< `main` after the last pose
    std::optional<MeasuredPose> last;  ///< the last pose
    MeasuredPose used;                 ///< the last one that was used
    std::size_t next = 0;              ///< the pose that follows
  };
  struct Waiting {
    MeasuredPose pose;
    bool late;
  };

  static double advance(State& state, double t, const Legs& legs, double misfit);
  void advance(Moment& moment, double t, const Legs& legs);
  State started(const MeasuredPose& pose, const PoseNoise& noise) const;
  Moment begun(const MeasuredPose& pose, std::size_t next) const;
  Eigen::Vector3d lasting_error(const MeasuredPose& pose, const PoseNoise& noise) const;
  double distance(const State& state, const MeasuredPose& pose, const PoseNoise& noise) const;
  static void correct(State& state, const MeasuredPose& pose, const PoseNoise& noise);
  void use(Moment& moment, const Waiting& waiting) const;
  static void learn_noise(Moment& moment, const MeasuredPose& last, const MeasuredPose& pose);
  void consider_other(Moment& moment, const MeasuredPose& pose) const;
  const Waiting& pose_at(std::size_t number) const { return poses_[number - first_]; }
  void work(const Legs& legs);
  void trim(double t);

  PoseFilterSettings settings_;
  PoseTimer timer_;
  PoseAccuracy accuracy_;
  std::deque<Waiting> poses_;  ///< the first is the one with number `first_`
  std::size_t first_ = 0;
  std::deque<Moment> moments_;
  double asked_ = -std::numeric_limits<double>::infinity();  ///< when the pose was asked for last [s]
};

}  // namespace slipwise
