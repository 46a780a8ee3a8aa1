// SPDX-License-Identifier: Apache-2.0
// Commands of throttle and steering as the twists that a car is known to make of them, at each moment of a run
// (derivations/sensors.md).
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "slipwise/identify/car_curve_filter.hpp"
#include "slipwise/lie/se2.hpp"
#include "slipwise/online/input_buffer.hpp"
#include "slipwise/online/pose_gate.hpp"

namespace slipwise {

/// Keeps the commands as they were given, learns the car's curves from poses, and remembers what was known when.
class CarStream {
 public:
  CarStream();
  /// `sensor` is where the pose sensor sits in base_link; a command is unknown once it is older than `unknown_after`.
  CarStream(const CarPrior& prior, const Pose2& sensor, double unknown_after);

  /// Another run begins; what was learned stays.
  void start_run();
  /// About what the car does under a command, by the estimate `latency` before it: the faster of what it does and
  /// what it goes towards. For gates; v is the throttle, omega the steering.
  BodyTwist expected(const InputSample& command, double latency) const;
  void push_command(const InputSample& command, double latency);
  /// Poses in order, none of them late or an outlier; commands are known until its stamp.
  void push_pose(const MeasuredPose& pose);
  /// Drops what is not needed after `t` [s].
  void drop_before(double t);

  /// Twists over [start, end] [s] and some seconds before, by the held curves or those known at `known` [s]. The speed
  /// at the start is what poses until then tell.
  InputHistory inputs(double start, double end, double known, const std::vector<InputSample>& future = {}) const;
  /// The same of cars that differ from it along the directions of its uncertainty.
  InputSpread spread(double start, double end, double known, const std::vector<InputSample>& future = {}) const;
  /// The same of a kinematic bicycle with the constant gains that fitted best until `known` [s].
  InputHistory baseline(double start, double end, double known) const;
  /// Commands as they were given.
  const InputBuffer& given() const { return given_; }
  const CarCurves& curves() const { return known_.back().curves; }

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const CarStream& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.sensor_, self.given_, self.filter_, self.known_, self.motions_, self.since_, self.now_, self.last_);
  }

 private:
  struct KnownCurves {
    double until;  ///< [s] nothing later was used
    CarCurves curves, straight;
    CarCurves lasting;  ///< for gates, which must not follow curves that began again
  };
  const KnownCurves& known_at(double t) const;
  /// By which inputs are made, where `known` [s] is known.
  const CarCurves& car_at(double known) const { return follower_ ? follower_->curves() : known_at(known).curves; }
  /// Twists over [start, end] [s] and some seconds before.
  InputHistory twists(const CarCurves& car, const InputHistory& commands, double start, double end) const;
  CarState state_at(double t, double latency) const;

  Pose2 sensor_;
  InputBuffer given_;
  CarCurveFilter filter_;
  /// Of the car by the curves of a model as it is; not saved, since what is saved learns.
  std::optional<CarCurveFilter> follower_;
  std::deque<KnownCurves> known_;
  std::deque<KnownMotion> motions_;
  std::optional<MeasuredPose> since_;  ///< where the twist begins that is being measured
  CarState now_;                       ///< about, at the last command
  std::optional<InputSample> last_;    ///< command
};

}  // namespace slipwise
