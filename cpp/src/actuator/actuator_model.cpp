// SPDX-License-Identifier: Apache-2.0
// The walk over delayed input changes that turns inputs into drive steps.
#include "slipwise/actuator/actuator_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "slipwise/actuator/axis_response.hpp"
#include "slipwise/actuator/axis_stepper.hpp"
#include "slipwise/actuator/first_order_lag.hpp"
#include "slipwise/actuator/kinematics.hpp"
#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr Eigen::Index kFixed = -1;
constexpr double kOfSampling = 0.03;  // [s] of a clock offset below zero that wheel speeds make, since they are held

/// Where the parameters of speed and yaw rate stand among the actuator's.
constexpr AxisPlaces kSpeedPlaces{
    .time_constant = 0, .delay = 2, .gain = 5, .slow_fraction = 7, .slow_time_constant = 9};
constexpr AxisPlaces kTurnPlaces{
    .time_constant = 1, .delay = 3, .gain = 6, .slow_fraction = 8, .slow_time_constant = 10};

/// A moment that moves with one of the actuator's parameters: later with a delay, earlier with the clock offset.
struct Knot {
  double t;
  Eigen::Index parameter;
};

/// By how much the time between two moments moves with each of N parameters: the actuator's, or none.
template <int N>
Eigen::Matrix<double, 1, N> derivative_between(const Knot& from, const Knot& until) {
  Eigen::Matrix<double, 1, N> row = Eigen::Matrix<double, 1, N>::Zero();
  if constexpr (N > 0) {
    for (const auto& [moment, sign] : {std::pair{until, 1.0}, std::pair{from, -1.0}}) {
      if (moment.parameter != kFixed) {
        row[moment.parameter] += moment.parameter == kClockOffset ? -sign : sign;
      }
    }
  }
  return row;
}

/// By how much a channel is delayed [s], and where that stands among the actuator's parameters.
struct ChannelDelay {
  double seconds;
  Eigen::Index parameter;
};

/// The samples of one channel as the drive sees them: delayed. Before the first command nothing was asked for; what
/// wheels did first they did before.
class DelayedCursor {
 public:
  DelayedCursor(const InputHistory& inputs, const ActuatorModel& actuator, const ChannelDelay& delay, double start,
                double known_until)
      : inputs_(inputs),
        wheelbase_(actuator.wheelbase),
        before_(actuator.follows_wheels && inputs.size() > 0 ? channel_input(inputs.sample(0), wheelbase_)
                                                             : BodyTwist{}),
        delay_(delay.seconds),
        index_(delay.parameter),
        next_(inputs.count_until(start - delay.seconds)),
        end_(std::max(next_, inputs.count_until(known_until))) {}

  BodyTwist held() const { return next_ == 0 ? before_ : channel_input(inputs_.sample(next_ - 1), wheelbase_); }
  bool before_first() const { return next_ == 0; }
  double next_change() const { return next_ < end_ ? inputs_.time(next_) + delay_ : kNever; }
  Knot change_knot() const { return {next_change(), index_}; }
  void advance() { ++next_; }
  std::size_t changes_left() const { return end_ - next_; }

  /// Skips samples before `t` that repeat the one held.
  void skip_repeats(double t) {
    while (next_ > 0 && next_change() < t && inputs_.sample(next_) == inputs_.sample(next_ - 1)) {
      ++next_;
    }
  }

 private:
  const InputHistory& inputs_;
  double wheelbase_;
  BodyTwist before_;
  double delay_;
  Eigen::Index index_;
  std::size_t next_;
  std::size_t end_;
};

/// Walks over the delayed input changes of a window, with derivatives by N parameters: the actuator's, or none.
template <int N>
class ActuatorWalk {
 public:
  ActuatorWalk(const InputHistory& inputs, const ActuatorModel& actuator, const ActuatorSpan& window)
      : actuator_(actuator),
        window_(window),
        speed_(speed_response(actuator)),
        turn_(yaw_rate_response(actuator)),
        start_(knot_of(window.start)),
        end_(knot_of(window.end)),
        model_start_(window.initial && window.known ? Knot{window.known->until, kFixed} : start_),
        warm_up_(warm_up()),
        rounding_(warm_up_ > 0.0 ? 0.0 : kSameStamp),
        cursor_v_(inputs, actuator, {actuator.delay_v, kSpeedPlaces.delay}, model_start_.t - warm_up_ + rounding_,
                  last_input(speed_.longest_lag())),
        cursor_omega_(inputs, actuator, {actuator.delay_omega, kTurnPlaces.delay},
                      model_start_.t - warm_up_ + rounding_, last_input(turn_.longest_lag())),
        v_(speed_, kSpeedPlaces),
        vy_(speed_, kSpeedPlaces),
        omega_(turn_, kTurnPlaces) {
    v_.settle(cursor_v_.held().v);
    vy_.settle(cursor_v_.held().vy);
    omega_.settle(cursor_omega_.held().omega);
  }

  ActuatorSteps run() {
    ActuatorSteps result;
    const std::size_t steps = cursor_v_.changes_left() + cursor_omega_.changes_left() + 2;
    result.steps.reserve(steps);
    result.jacobians.reserve(N > 0 ? steps : 0);
    if (warm_up_ > 0.0) {
      approach({model_start_.t - warm_up_, kFixed}, model_start_);
    }
    if (window_.initial) {
      start_at(cursor_v_, v_, window_.initial->v);
      start_at(cursor_v_, vy_, window_.initial->vy);
      start_turn(*window_.initial);
    }
    if (window_.known && start_.t < model_start_.t) {
      follow_measured(*window_.known->twist, result);
    } else if (start_.t > model_start_.t) {
      approach(model_start_, start_);
    }
    cover(start_.t < model_start_.t ? model_start_ : start_, result);
    return result;
  }

 private:
  using Axis = AxisStepper<N>;
  using Row = Axis::Row;
  static constexpr bool kDerivatives = N > 0;

  /// Stamp of the last input that may drive an axis in the window [s]: of poses that are stamped early, one after its
  /// end. What lags is that much later than its clock says.
  double last_input(double lag) const {
    return std::clamp(end_.t - kOfSampling - lag, window_.end, window_.end + window_.ahead);
  }

  Knot knot_of(double stamp) const { return {stamp - actuator_.clock_offset, kClockOffset}; }

  bool steers() const { return actuator_.wheelbase > 0.0; }

  /// How long the state at the start hangs on earlier inputs: where the drive was measured, its parts alone do.
  double warm_up() const {
    if (!window_.initial) {
      return kSettledLags * std::max(speed_.longest_lag(), turn_.longest_lag());
    }
    const double parts = parts_warm_up(speed_, turn_);
    return steers() ? std::max(parts, kSettledLags * turn_.longest_lag()) : parts;
  }

  /// An axis where the actuator starts, as it was measured.
  void start_at(const DelayedCursor& cursor, Axis& axis, double measured) const {
    if (cursor.before_first()) {
      axis.keep(measured);
    } else {
      axis.measure(measured, !window_.known || !window_.known->any_inputs);
    }
  }

  /// The second channel of a measured drive. Commands tell a steering better than a yaw rate does, which may be none
  /// that was measured, but made of the commanded steering; before any acts, it is what the yaw rate asks for.
  void start_turn(const BodyTwist& measured) {
    if (!steers()) {
      start_at(cursor_omega_, omega_, measured.omega);
    } else if (cursor_omega_.before_first() && shows_curvature(measured)) {
      omega_.keep(curvature_of(measured, actuator_.wheelbase));
    }
  }

  /// Records the drive as it was measured, from the start until the actuator takes over.
  void follow_measured(const InputHistory& twist, ActuatorSteps& out) const {
    const Knot until = model_start_.t < end_.t ? model_start_ : end_;
    std::size_t next = twist.count_until(start_.t);
    for (Knot now = start_; now.t < until.t; ++next) {
      const bool last = next >= twist.size() || twist.time(next) >= until.t;
      const Knot then = last ? until : Knot{twist.time(next), kFixed};
      const BodyTwist held = next == 0 ? BodyTwist{} : twist.sample(next - 1);
      const double duration = then.t - now.t;
      out.steps.push_back({duration, held.v * duration, held.vy * duration, held.omega * duration});
      if constexpr (kDerivatives) {
        const Row derivative = derivative_between<N>(now, then);
        out.jacobians.emplace_back() << derivative, held.v * derivative, held.vy * derivative, held.omega * derivative;
      }
      now = then;
    }
  }

  /// Goes from `from` to `until` unseen: each channel by its own changes.
  void approach(const Knot& from, const Knot& until) {
    approach(cursor_v_, speed_, from, until, std::array{Driven{v_, &BodyTwist::v}, Driven{vy_, &BodyTwist::vy}});
    approach(cursor_omega_, turn_, from, until, std::array{Driven{omega_, &BodyTwist::omega}});
  }

  /// An axis, and the part of the inputs that it follows.
  struct Driven {
    Axis& axis;
    double BodyTwist::* part;
  };

  void approach(DelayedCursor& cursor, const AxisResponse& response, Knot now, const Knot& until,
                std::span<const Driven> driven) const {
    while (now.t < until.t) {
      cursor.skip_repeats(until.t);
      const Knot next = cursor.next_change() < until.t ? cursor.change_knot() : until;
      const AxisDecay decay(response, next.t - now.t);
      const Row derivative = derivative_between<N>(now, next);
      for (const Driven& its : driven) {
        its.axis.follow(decay, derivative);
      }
      if (cursor.next_change() <= next.t) {
        cursor.advance();
        for (const auto& [axis, part] : driven) {
          axis.hold(cursor.held().*part);
        }
      }
      now = next;
    }
  }

  /// Steps from `now` to the end.
  void cover(Knot now, ActuatorSteps& out) {
    while (now.t < end_.t) {
      const double change = std::min(cursor_v_.next_change(), cursor_omega_.next_change());
      Knot next = end_;
      if (change < end_.t - rounding_) {
        next = cursor_v_.next_change() <= change ? cursor_v_.change_knot() : cursor_omega_.change_knot();
      }
      subdivide(now, next, out);
      advance_cursors(next.t);
      now = next;
    }
  }

  /// Changes of the two channels are taken one at a time, since they move apart with their delays; without delays,
  /// together.
  void advance_cursors(double t) {
    const bool v_changes = cursor_v_.next_change() <= t;
    const bool omega_changes = cursor_omega_.next_change() <= t;
    const bool together = actuator_.delay_v == 0.0 && actuator_.delay_omega == 0.0;
    if (v_changes) {
      cursor_v_.advance();
      v_.hold(cursor_v_.held().v);
      vy_.hold(cursor_v_.held().vy);
    }
    if (omega_changes && (together || !v_changes)) {
      cursor_omega_.advance();
      omega_.hold(cursor_omega_.held().omega);
    }
  }

  void subdivide(const Knot& from, const Knot& to, ActuatorSteps& out) {
    const bool lagging = speed_.longest_lag() > 0.0 || turn_.longest_lag() > 0.0;
    const int parts = lagging ? lag_parts(to.t - from.t, window_.longest_step) : 1;
    const double duration = (to.t - from.t) / parts;
    const AxisDecay decay_v(speed_, duration);
    const AxisDecay decay_omega(turn_, duration);
    const Row derivative = derivative_between<N>(from, to) * (1.0 / parts);
    const bool moving = lagging || from.parameter != to.parameter;
    for (int i = 0; i < parts; ++i) {
      if (kDerivatives && moving) {
        linearized_step(decay_v, decay_omega, derivative, out);
      } else {
        step(decay_v, decay_omega, out);
      }
    }
  }

  void step(const AxisDecay& decay_v, const AxisDecay& decay_omega, ActuatorSteps& out) {
    const double duration = decay_v.fast.duration;
    out.steps.push_back(
        {duration, v_.advance_value(decay_v), vy_.advance_value(decay_v), omega_.advance_value(decay_omega)});
    if constexpr (kDerivatives) {  // without lag, and where no duration moves, only the gains tell
      ActuatorStepJacobian& jacobian = out.jacobians.emplace_back(ActuatorStepJacobian::Zero());
      jacobian(1, kSpeedPlaces.gain) = v_.by_gain(duration);
      jacobian(2, kSpeedPlaces.gain) = vy_.by_gain(duration);
      jacobian(3, kTurnPlaces.gain) = omega_.by_gain(duration);
    }
    follow_kinematics(out);
  }

  void linearized_step(const AxisDecay& decay_v, const AxisDecay& decay_omega, const Row& derivative,
                       ActuatorSteps& out) {
    const auto forward = v_.advance(decay_v, derivative);
    const auto left = vy_.advance(decay_v, derivative);
    const auto turn = omega_.advance(decay_omega, derivative);
    out.steps.push_back({decay_v.fast.duration, forward.value, left.value, turn.value});
    if constexpr (kDerivatives) {
      out.jacobians.emplace_back() << derivative, forward.derivative, left.derivative, turn.derivative;
    }
    follow_kinematics(out);
  }

  /// What the last step does of what its channels did.
  void follow_kinematics(ActuatorSteps& out) const {
    if (!steers()) {
      return;
    }
    if constexpr (kDerivatives) {
      steer(out.steps.back(), out.jacobians.back());
    } else {
      steer(out.steps.back());
    }
  }

  const ActuatorModel& actuator_;
  const ActuatorSpan& window_;
  AxisResponse speed_;
  AxisResponse turn_;
  Knot start_;
  Knot end_;
  Knot model_start_;
  double warm_up_;
  /// [s] Without lag, the derivative by a delay jumps where a change passes an end of the window, and must not hang on
  /// the last bit of a stamp: what changes there by rounding alone has changed at the start, and has not at the end.
  double rounding_;
  DelayedCursor cursor_v_;
  DelayedCursor cursor_omega_;
  Axis v_, vy_, omega_;
};

}  // namespace

ActuatorSteps actuator_steps(const InputHistory& inputs, const ActuatorModel& actuator, const ActuatorSpan& window) {
  return ActuatorWalk<0>(inputs, actuator, window).run();
}

ActuatorSteps linearize_actuator_steps(const InputHistory& inputs, const ActuatorModel& actuator,
                                       const ActuatorSpan& window) {
  return ActuatorWalk<kActuatorParameters>(inputs, actuator, window).run();
}

}  // namespace slipwise
