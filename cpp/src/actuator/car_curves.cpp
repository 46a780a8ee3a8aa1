// SPDX-License-Identifier: Apache-2.0
// Steps of a car under held throttle and steering.
#include "slipwise/actuator/car_curves.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "slipwise/actuator/car_stages.hpp"
#include "slipwise/actuator/first_order_lag.hpp"
#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kPiece = 0.05;    // [s] over which a twist is averaged
constexpr double kLongest = 0.02;  // [s] of a step; over it the yaw rate in the drag is held

/// Twists averaged over pieces.
class Pieces {
 public:
  void add(double t, const BodyTwist& twist, double duration) {
    if (seconds_ == 0.0) {
      start_ = t;
    }
    sum_.v += duration * twist.v;
    sum_.vy += duration * twist.vy;
    sum_.omega += duration * twist.omega;
    seconds_ += duration;
    if (!later(kPiece, seconds_)) {
      close();
    }
  }
  InputHistory inputs() && {
    close();
    return {std::move(t_), std::move(twist_)};
  }

 private:
  void close() {
    if (seconds_ > 0.0) {
      t_.push_back(start_);
      twist_.push_back({.v = sum_.v / seconds_, .vy = sum_.vy / seconds_, .omega = sum_.omega / seconds_});
    }
    sum_ = {};
    seconds_ = 0.0;
  }

  std::vector<double> t_;
  std::vector<BodyTwist> twist_;
  BodyTwist sum_{};
  double start_ = 0.0, seconds_ = 0.0;
};

/// The car from one moment on; `measured` replaces its speed when its time comes.
class Drive {
 public:
  Drive(const CarCurves& car, const CarSpan& span) : car_(car), span_(span) {}

  /// Under a command held over [from, to] [s].
  void hold(const BodyTwist& command, double from, double to) {
    double now = from;
    while (later(to, now)) {
      double next = std::min(to, now + kLongest);
      const KnownMotion* motion = span_.measured && !set_ ? &*span_.measured : nullptr;
      const bool measured = motion != nullptr && later(next, motion->t);
      if (measured) {
        next = std::max(motion->t, now);
      } else if (now < span_.start && span_.start < next) {
        next = span_.start;
      }
      const CarState before = state_;
      state_ = advanced(car_, state_, command, next - now);
      if (!later(span_.start, now) && later(next, now)) {
        const CarState middle{.speed = 0.5 * (before.speed + state_.speed),
                              .steering = 0.5 * (before.steering + state_.steering)};
        pieces_.add(now, with_rest(car_twist(car_, middle), 0.5 * (now + next)), next - now);
      }
      if (measured) {  // from here on
        state_.speed = motion->speed;
        set_ = true;
      }
      now = next;
    }
  }
  InputHistory inputs() && { return std::move(pieces_).inputs(); }

 private:
  BodyTwist with_rest(BodyTwist twist, double t) const {
    if (set_ && span_.measured) {
      const KnownMotion& measured = *span_.measured;
      twist.omega += lag_output(measured.turn, 0.0, measured.turn_lag, t - measured.t);
      twist.vy += lag_output(measured.sideways, 0.0, measured.sideways_lag, t - measured.t);
    }
    return twist;
  }

  const CarCurves& car_;
  const CarSpan& span_;
  CarState state_;
  bool set_ = false;
  Pieces pieces_;
};

/// What advance_car needs, in doubles.
struct CarFunctions {
  const CarCurves& car;
  double duration;  ///< of a step [s]

  double curvature(double steering) const { return car.curvature(steering); }
  static double size(double x) { return std::abs(x); }
  double left(double drag) const { return lag_output(1.0, 0.0, car.lag / drag, duration); }
};

/// [s] after which a car has forgotten its earlier commands.
double settling(const CarCurves& car) { return 10.0 * std::max(car.lag, car.steering_lag) + 1.0; }

}  // namespace

double settled_after(const CarCurves& car, const InputHistory& commands, double start) {
  const double last = commands.size() > 0 ? commands.time(commands.size() - 1) : start;
  return std::max(last, start) + settling(car);
}

double KnotCurve::operator()(double x) const {
  if (at.empty()) {
    return 0.0;
  }
  const auto above = static_cast<std::size_t>(std::ranges::upper_bound(at, x) - at.begin());
  if (above == 0) {
    return value.front();
  }
  if (above == at.size()) {
    return value.back();
  }
  const double part = (x - at[above - 1]) / (at[above] - at[above - 1]);
  return value[above - 1] + part * (value[above] - value[above - 1]);
}

BodyTwist car_twist(const CarCurves& car, const CarState& state) {
  return {
      .v = state.speed, .vy = 0.0, .omega = car_yaw_rate(state.speed, car.curvature(state.steering), car.understeer)};
}

CarState advanced(const CarCurves& car, const CarState& state, const BodyTwist& command, double duration) {
  const CarStep<double> step{.cornering_drag = car.cornering_drag,
                             .understeer = car.understeer,
                             .steering_left = lag_output(1.0, 0.0, car.steering_lag, duration)};
  const CarLanes<double> after = advance_car(step, CarFunctions{.car = car, .duration = duration},
                                             CarLanes<double>{.speed = state.speed, .steering = state.steering},
                                             car.speed(command.v), command.omega);
  return {.speed = after.speed, .steering = after.steering};
}

InputHistory car_twists(const CarCurves& car, const InputHistory& commands, const CarSpan& span) {
  const double begin = std::min(span.start, span.measured ? span.measured->t : span.start) - settling(car);
  Drive drive(car, span);
  for (std::size_t i = 0; i < commands.size() && commands.time(i) < span.end; ++i) {
    const double next = i + 1 < commands.size() ? std::min(commands.time(i + 1), span.end) : span.end;
    if (next > begin) {
      drive.hold(commands.sample(i), std::max(commands.time(i), begin), next);
    }
  }
  return std::move(drive).inputs();
}

}  // namespace slipwise
