// SPDX-License-Identifier: Apache-2.0
// One pass over the steps of a manoeuvre: lag by lag, pose by pose, with derivatives carried along.
#include "slipwise/planning/manoeuvre_end.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "slipwise/actuator/axis_response.hpp"
#include "slipwise/actuator/axis_stepper.hpp"
#include "slipwise/actuator/command_limiter.hpp"
#include "slipwise/actuator/kinematics.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/segment/ground_step.hpp"
#include "slipwise/segment/path_step.hpp"

namespace slipwise {
namespace {

constexpr double kNoStamp = 0.0;                                      // [s]; a plane or a map is the same at any time
using StepJacobian = Eigen::Matrix<double, 4, kManoeuvreParameters>;  // duration, forward, left, turn
constexpr double kLongestStep = ActuatorSpan{.start = 0.0, .end = 0.0}.longest_step;  // [s]

/// Speeds move with the manoeuvre's length alone, the yaw rate with all parameters.
using SpeedAxis = AxisStepper<1>;
using YawRateAxis = AxisStepper<kManoeuvreParameters>;

/// An axis that is at `drive` while `commanded` acts. What the fast mode does not explain is the slow mode's; where the
/// fast one is not known, it is settled.
template <int N>
AxisStepper<N> started(const AxisResponse& response, double drive, double commanded, std::optional<double> known_fast) {
  AxisStepper<N> axis(response);
  const double fast = response.has_slow_mode() ? known_fast.value_or(response.fast_fraction() * commanded) : drive;
  axis.start({.value = fast}, {.value = drive - fast});
  axis.hold(Sensitive<N>{.value = commanded});
  return axis;
}

/// The pose as it grows, and the sums that give its derivative.
class GrowingEnd {
 public:
  GrowingEnd(const PlanningModel& model, const Ground* ground)
      : model_(model), ground_(ground), features_(model.basis().size()) {}

  /// Drives one step; `jacobian` is null where no derivative is asked for.
  void drive(const ActuatorStep& step, const StepJacobian* jacobian) {
    if (ground_ == nullptr) {
      drive_level(step, jacobian);
    } else if (jacobian == nullptr) {
      const GroundStep at = ground_step(*ground_, step, pose_, kNoStamp);
      move(at.seen_from_above(tangent_of(step, slip_at(step, at.gravity))));
    } else {
      drive_linearized(step, *jacobian, linearize_ground_step(*ground_, step, pose_, kNoStamp));
    }
  }

  const Pose2& pose() const { return pose_; }
  ManoeuvreJacobian jacobian() const { return transition(Pose2{}, pose_) * sums_; }

 private:
  PathSlip along(const BodyGravity& gravity) const {
    return {.basis = model_.basis(), .alpha = model_.alpha(), .gravity = gravity};
  }

  Eigen::Vector3d slip_at(const ActuatorStep& step, const BodyGravity& gravity) {
    model_.basis().features(slip_state(step, gravity), features_);
    return slip_rate(model_.basis(), model_.alpha(), features_);
  }

  void drive_level(const ActuatorStep& step, const StepJacobian* jacobian) {
    const Eigen::Vector3d slip = slip_at(step, {});
    const Eigen::Vector3d tangent = tangent_of(step, slip);
    const Eigen::Matrix2d heading = heading_;
    const auto arc = move(tangent);
    if (jacobian != nullptr) {
      sums_.noalias() += start_by_tangent(heading, tangent, arc, pose_) * tangent_by(step, *jacobian, along({}), slip);
    }
  }

  /// The place of the step moves its tilt, so that what was driven before it counts too.
  void drive_linearized(const ActuatorStep& step, const StepJacobian& jacobian, const GroundStepLinearization& at) {
    const PathSlip slips = along(at.step.gravity);
    const Eigen::Vector3d slip = slip_at(step, at.step.gravity);
    const Eigen::Vector3d body = tangent_of(step, slip);
    const Eigen::Vector3d tangent = at.step.seen_from_above(body);
    const Eigen::Matrix2d heading = heading_;
    const Pose2 before = pose_;
    const auto arc = move(tangent);
    const Eigen::Matrix3d by_tangent = start_by_tangent(heading, tangent, arc, pose_);
    const Eigen::Matrix3d by_place = by_tangent * above_by_place(at, step, slips, body);
    sums_ += (by_place * (at.at_by_pose * transition(Pose2{}, before) * sums_ + at.at_by_step * jacobian) +
              by_tangent * at.step.level * tangent_by(step, jacobian, slips, slip))
                 .eval();
  }

  /// Appends an exact arc as it is seen from above.
  ArcFunctions<double> move(const Eigen::Vector3d& tangent) {
    const auto arc = arc_functions(tangent.z());
    const Eigen::Vector2d moved = heading_ * (arc_matrix(arc) * tangent.head<2>());
    pose_ = {pose_.x + moved.x(), pose_.y + moved.y(), pose_.theta + tangent.z()};
    const Eigen::Vector2d ahead = heading_ * Eigen::Vector2d(arc.cos_turn, arc.sin_turn);
    heading_ << ahead.x(), -ahead.y(), ahead.y(), ahead.x();
    return arc;
  }

  const PlanningModel& model_;
  const Ground* ground_;
  std::vector<double> features_;
  Pose2 pose_;
  Eigen::Matrix2d heading_ = Eigen::Matrix2d::Identity();
  ManoeuvreJacobian sums_ = ManoeuvreJacobian::Zero();
};

/// Walks over the moments at which a delayed command begins to act in one of the channels.
class ManoeuvreWalk {
 public:
  ManoeuvreWalk(const PlanningModel& model, const ManoeuvreFrame& frame, const ManoeuvreVector& parameters,
                const ActuatorState& start)
      : ManoeuvreWalk(model, frame.ground.get(),
                      limited_commands(held_commands(frame, parameters), model.limits(), start.commanded), start) {}

  template <bool kDerivatives>
  void run() {
    const auto count = static_cast<double>(held_.end);
    const Knot end{count * held_.period.value + held_.settling, count * held_.period.derivative};
    Knot now{0.0, 0.0};
    while (now.t < end.t) {
      const Knot next_v = acts(next_v_, actuator_.delay_v), next_omega = acts(next_omega_, actuator_.delay_omega);
      Knot next = next_v.t <= next_omega.t ? next_v : next_omega;
      next = next.t < end.t ? next : end;
      subdivide<kDerivatives>(now, next);
      if (next_v.t <= next.t) {
        tell_speed();
      }
      if (next_omega.t <= next.t) {
        tell_yaw_rate();
      }
      now = next;
    }
  }

  /// The path is recorded into `path` from now on.
  void record(ManoeuvrePath& path) {
    path_ = &path;
    path.t.push_back(0.0);
    path.poses.push_back(end_.pose());
  }

  BodyTwist drive() const {
    return {.v = v_.whole().value, .vy = vy_.whole().value, .omega = turning(omega_.whole().value)};
  }
  BodyTwist fast() const {
    return {.v = v_.fast().value, .vy = vy_.fast().value, .omega = turning(omega_.fast().value)};
  }
  Pose2 pose() const { return end_.pose(); }
  ManoeuvreJacobian jacobian() const { return end_.jacobian(); }

 private:
  ManoeuvreWalk(const PlanningModel& model, const Ground* ground, HeldCommands held, const ActuatorState& start)
      : ManoeuvreWalk(model, ground, std::move(held), start, settled(model.limits(), start.commanded)) {}

  /// `commanded` is what the limits gave before the start.
  ManoeuvreWalk(const PlanningModel& model, const Ground* ground, HeldCommands held, const ActuatorState& start,
                const BodyTwist& commanded)
      : actuator_(model.actuator()),
        held_(std::move(held)),
        v_(started<1>(speed_response(model.actuator()), start.drive.v, commanded.v, fast_of(start, &BodyTwist::v))),
        vy_(started<1>(speed_response(model.actuator()), start.drive.vy, commanded.vy, fast_of(start, &BodyTwist::vy))),
        omega_(started_turn(model.actuator(), start, commanded)),
        tilted_(ground != nullptr),
        end_(model, ground) {}

  static std::optional<double> fast_of(const ActuatorState& start, double BodyTwist::* channel) {
    return start.fast ? std::optional<double>((*start.fast).*channel) : std::nullopt;
  }

  /// The yaw rate, or the curvature of a drive that steers: that of another plan's end, or else the commanded one.
  static YawRateAxis started_turn(const ActuatorModel& actuator, const ActuatorState& start,
                                  const BodyTwist& commanded) {
    const AxisResponse response = yaw_rate_response(actuator);
    const std::optional<double> fast = fast_of(start, &BodyTwist::omega);
    if (!(actuator.wheelbase > 0.0)) {
      return started<kManoeuvreParameters>(response, start.drive.omega, commanded.omega, fast);
    }
    const double told = curvature_of(commanded, actuator.wheelbase);
    if (!fast || !shows_curvature(start.drive)) {
      return started<kManoeuvreParameters>(response, response.gain * told, told, std::nullopt);
    }
    return started<kManoeuvreParameters>(response, curvature_of(start.drive, actuator.wheelbase), told,
                                         *fast / start.drive.v);
  }

  bool steers() const { return actuator_.wheelbase > 0.0; }
  /// What the drive turns by where its second channel does this.
  double turning(double channel) const { return steers() ? v_.whole().value * channel : channel; }

  /// A time and its derivative by the manoeuvre's length.
  struct Knot {
    double t;
    double derivative;
  };

  Knot acts(std::size_t command, double delay) const {
    if (command >= held_.commands.size()) {
      return {kNever, 0.0};
    }
    const auto k = static_cast<double>(command);
    return {delay + k * held_.period.value, k * held_.period.derivative};
  }

  void tell_speed() {
    const HeldCommand& command = held_.commands[next_v_++];
    v_.hold({command.v, SpeedAxis::Row(command.v_by_length)});
    vy_.hold(0.0);
  }

  void tell_yaw_rate() {
    const HeldCommand& command = held_.commands[next_omega_++];
    if (!steers()) {
      omega_.hold({command.omega, command.omega_by});
      return;
    }
    const double curvature = curvature_of({.v = command.v, .omega = command.omega}, actuator_.wheelbase);
    if (command.v == 0.0 || std::abs(curvature) >= sharpest_curvature(actuator_.wheelbase)) {
      omega_.hold({.value = curvature});
      return;
    }
    omega_.hold(
        {curvature, (command.omega_by - curvature * command.v_by_length * ManoeuvreRow::Unit(kLength)) / command.v});
  }

  template <bool kDerivatives>
  void subdivide(const Knot& from, const Knot& to) {
    const bool lagging =
        speed_response(actuator_).longest_lag() > 0.0 || yaw_rate_response(actuator_).longest_lag() > 0.0;
    const int for_tilt = tilted_ ? static_cast<int>(ground_pieces(to.t - from.t)) : 1;
    const int parts = std::max(lagging ? lag_parts(to.t - from.t, kLongestStep) : 1, for_tilt);
    const double duration = (to.t - from.t) / parts;
    const AxisDecay decay_v(speed_response(actuator_), duration), decay_omega(yaw_rate_response(actuator_), duration);
    for (int i = 0; i < parts; ++i) {
      if constexpr (kDerivatives) {
        const double derivative = (to.derivative - from.derivative) / parts;
        const auto forward = v_.advance(decay_v, SpeedAxis::Row(derivative));
        const auto left = vy_.advance(decay_v, SpeedAxis::Row(derivative));
        const auto turn = omega_.advance(decay_omega, derivative * ManoeuvreRow::Unit(kLength));
        StepJacobian jacobian = StepJacobian::Zero();
        jacobian.col(kLength).head<3>() << derivative, forward.derivative, left.derivative;
        jacobian.row(3) = turn.derivative;
        ActuatorStep step{duration, forward.value, left.value, turn.value};
        if (steers()) {
          steer(step, jacobian);
        }
        end_.drive(step, &jacobian);
      } else {
        ActuatorStep step{duration, v_.advance_value(decay_v), vy_.advance_value(decay_v),
                          omega_.advance_value(decay_omega)};
        if (steers()) {
          steer(step);
        }
        end_.drive(step, nullptr);
      }
      if (path_ != nullptr) {
        path_->t.push_back(from.t + (i + 1) * duration);
        path_->poses.push_back(end_.pose());
      }
    }
  }

  const ActuatorModel& actuator_;
  HeldCommands held_;
  SpeedAxis v_, vy_;
  YawRateAxis omega_;
  std::size_t next_v_ = 0;
  std::size_t next_omega_ = 0;
  bool tilted_;
  GrowingEnd end_;
  ManoeuvrePath* path_ = nullptr;
};

}  // namespace

PlanningModel::PlanningModel(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                             const CommandLimits& limits)
    : basis_(model.basis()), limits_(limits) {
  check(limits);
  model.check(parameters);
  if (basis_.by_heading()) {
    throw std::invalid_argument("planning knows no heading in the frame of the poses, and a slip term depends on it");
  }
  if (model.learned().wheelbase > 0.0 && !unlimited(limits)) {
    throw std::invalid_argument("limits are of yaw rates, and this model steers; leave them out");
  }
  alpha_ = parameters.head(model.slip_size());
  actuator_ = model.actuator(parameters);
  actuator_.clock_offset = 0.0;
  actuator_.delay_v = std::max(actuator_.delay_v, 0.0);  // a learned value below it is an offset of clocks too
  actuator_.delay_omega = std::max(actuator_.delay_omega, 0.0);
}

Pose2 manoeuvre_pose(const PlanningModel& model, const ManoeuvreFrame& frame, const ManoeuvreVector& parameters,
                     const ActuatorState& start) {
  ManoeuvreWalk walk(model, frame, parameters, start);
  walk.run<false>();
  return walk.pose();
}

ManoeuvrePath manoeuvre_path(const PlanningModel& model, const ManoeuvreFrame& frame, const ManoeuvreVector& parameters,
                             const ActuatorState& start) {
  ManoeuvrePath path;
  ManoeuvreWalk walk(model, frame, parameters, start);
  walk.record(path);
  walk.run<false>();
  path.drive = walk.drive();
  path.fast = walk.fast();
  return path;
}

ManoeuvreEnd linearize_manoeuvre(const PlanningModel& model, const ManoeuvreFrame& frame,
                                 const ManoeuvreVector& parameters, const ActuatorState& start) {
  ManoeuvreWalk walk(model, frame, parameters, start);
  walk.run<true>();
  return {walk.pose(), walk.jacobian()};
}

}  // namespace slipwise
