// SPDX-License-Identifier: Apache-2.0
// Learns a motion model from one measurement at a time, live or from a log: the same thing.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slipwise/hypotheses/motion_hypotheses.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/held_out.hpp"
#include "slipwise/online/learner_log.hpp"
#include "slipwise/online/learner_settings.hpp"
#include "slipwise/online/localizer.hpp"
#include "slipwise/online/segment_learner.hpp"
#include "slipwise/online/segment_stream.hpp"

namespace slipwise {

/// The filter over poses that goes with a learner.
PoseFilterSettings pose_filter_settings(const LearnerSettings& settings);

/// What is known of the time ahead beside the inputs.
struct KnownAhead {
  std::vector<KnownForce> forces = {};     ///< that will push the robot, each until the next; before, the last pushed
  const ActuatorLimits* limits = nullptr;  ///< of the drive, as they were found; none: it has none
};

/// A path that is predicted from now on.
struct PredictedPath {
  double start;                              ///< [s]
  std::vector<double> t;                     ///< [N] s, the last at the horizon
  std::vector<Eigen::Vector3d> poses;        ///< [N] of base_link in the frame of its pose at the start
  std::vector<Eigen::Matrix3d> covariances;  ///< [N] of a Student t each, its inflation included
  std::vector<StudentT> students;            ///< [N] of the nearest horizon whose errors are known
  Structure structure;                       ///< that predicts
};

/// What was learned so far.
struct LearnedModel {
  Knowledge known;
  std::vector<StudentT> students;            ///< per horizon, nothing recent being known
  std::vector<HeldOutPredictions> held_out;  ///< per horizon, the last of them
  std::array<double, kStructures> weights;   ///< of the structures
  DrivenRange range;                         ///< what was driven
  double seconds;                            ///< of all segments learned
  std::size_t segments;
  RejectionCounts rejected;
  std::optional<CarCurves> car = {};        ///< where commands are throttle and steering
  MotionEvidence evidence = {};             ///< whether poses and inputs contradict each other
  JudgedTargets targets = JudgedTargets();  ///< what was judged of late
};

/// Streams must be in order each; they may be late relative to each other by the latency of the settings. No push
/// throws for what was measured: what is wrong is rejected, counted, and said as an event.
class MotionLearner {
 public:
  /// \throws std::invalid_argument when a setting is impossible.
  explicit MotionLearner(const LearnerSettings& settings);
  MotionLearner(const MotionLearner&);
  MotionLearner(MotionLearner&&) noexcept;
  MotionLearner& operator=(const MotionLearner&);
  MotionLearner& operator=(MotionLearner&&) noexcept;
  ~MotionLearner();

  /// The run so far is complete and another begins: nothing is joined across runs; what was learned stays.
  void start_run();
  /// Nothing more comes of this run: what waits for later measurements is learned.
  void end_run();
  /// Takes a measurement of any kind. Of a car (`StreamSettings::car`) v of a command is the throttle and omega the
  /// steering. Of a position alone the heading is taken from the course of its path; odometry needs poses. A gyro's
  /// bias is learned. A known force pushes as gravity does on a slope; beside attitudes it is rejected.
  void push(const Measurement& measurement);

  /// What happened since the last call; the oldest are dropped, and counted, when they wait for long.
  std::vector<LearnerEvent> events() { return learner_.log().take_events(); }
  std::size_t dropped_events() const { return learner_.log().dropped(); }

  /// Where the robot will be if it is given the `future` inputs, over `horizon` [s] from the newest measurement on.
  /// Parameters are those known `embargo` [s] before.
  /// \throws std::invalid_argument when the horizon is not positive or longer than an hour, or an input is impossible.
  PredictedPath predict(const std::vector<InputSample>& future, double horizon, double embargo = 0.0,
                        const KnownAhead& known = {});
  /// Where the robot is at the newest measurement: the measured poses, and the learned motion since the last of them.
  /// Nothing before the first pose of the run. It does not change the learned model, and it is not saved: a learner
  /// that was loaded begins again with the next pose, for the robot may have been moved meanwhile.
  std::optional<Odometry> odometry();
  /// Whether the robot moves as its inputs and the learned model say it must. It does not change the learned model,
  /// and it is not saved.
  MotionState motion_monitor();
  /// A copy whose run has ended.
  MotionLearner completed() const;
  /// What was learned of all that was pushed; as if the run ended now.
  LearnedModel model() const;
  /// Looks for limits of the actuator in the last commands and wheel speeds, or twists between poses where there are no
  /// wheel speeds, and keeps them where they predict better. This takes up to seconds, and changes nothing of what is
  /// learned. Empty if there are too few of these.
  std::optional<ActuatorLimits> find_limits(double wheel_separation) const;
  /// Gives what is the terrain's `fraction` of its prior variance back: a cue from any other sensor.
  /// \throws std::invalid_argument when the fraction is not between 0 and 1.
  void forget(double fraction);
  /// Another drive begins, after a while or elsewhere: the run so far is complete, and where surfaces are remembered,
  /// each of them may be the one under the robot. What was learned of the robot stays.
  void start_drive(const DriveStart& start = {});
  /// The surface changes now by a label: to the one of this name, or to another where it is empty. Where no
  /// surfaces are remembered, a name says nothing, and without one slip may jump.
  void cue_surface(const std::string& label);
  /// A sensor says what the terrain under the robot is now: a prior for the surfaces that it said that on before, as
  /// far as surfaces are remembered. Each answer, in the order of time, as soon as it is known.
  /// \throws std::invalid_argument when the answer has numbers that are no probabilities.
  void cue_terrain(const TerrainAnswer& answer);
  /// The surfaces that are remembered, the present one as it is known now.
  SurfaceBank surfaces() const;
  /// What happened to them since the last call; the oldest are dropped when they wait for long.
  std::vector<DatedSurfaceEvent> surface_events() { return learner_.log().take_surface_events(); }
  /// Begins with what another learner knew: its robot, its slip disturbance `law` and the surfaces it remembers. How
  /// large errors are is learned again. `wheels` says whether wheel speeds will come beside the commands.
  /// \throws std::invalid_argument when something was learned already, or the terms are not those that are learned.
  void begin_with(const KnownBefore& known, const DisturbanceModel& law, bool wheels);
  /// Takes in the surfaces of another learner of the same robot; returns their names here. Those that cannot be told
  /// apart from one that is known are merged with it (`surface_events`).
  /// \throws std::invalid_argument when the terms are not those that are learned.
  std::vector<std::string> add_surfaces(const KnownBefore& other);

  /// What was learned: structures and surfaces, sources of poses.
  const SegmentLearner& learned() const { return learner_; }
  /// What was measured: the bias of a gyro, how the sensor of roll and pitch sits, what contradicts each other.
  const SegmentStream& stream() const { return stream_; }
  /// All of it as bytes, from which `load` makes a learner that goes on to the same results.
  std::string save() const;
  /// \throws std::invalid_argument, saying what to do, when these are not the bytes that this version saved.
  static MotionLearner load(std::string_view saved);

  /// Stamp of the newest measurement of the run [s]; minus infinity before the first.
  double newest() const { return clock().stamp(stream_.newest()); }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.learner_, self.stream_, self.run_begins_, self.before_run_);
  }

 private:
  double counted(double stamp);
  const RunClock& clock() const { return learner_.log().clock(); }
  MotionNow motion_now();

  SegmentStream stream_;
  SegmentLearner learner_;       ///< by its clock all stamps here are counted
  Localizer localizer_;          ///< not saved
  bool run_begins_ = true;       ///< no measurement of the run has come yet
  double before_run_ = -kNever;  ///< newest stamp of the runs before [s]
};

}  // namespace slipwise
