// SPDX-License-Identifier: Apache-2.0
// Steps of a car under held throttle and steering.
#include "slipwise/actuator/car_curves.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "slipwise/actuator/car_stages.hpp"
#include "slipwise/actuator/first_order_lag.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/linear/symmetric_eigen.hpp"

namespace slipwise {
namespace {

constexpr double kPiece = 0.05;       // [s] over which a twist is averaged
constexpr double kLongest = 0.02;     // [s] of a step; over it the yaw rate in the drag is held
constexpr double kDeviation = 0.1;    // standard deviations, small enough for a derivative
constexpr double kNegligible = 1e-4;  // of the largest variance, of a direction that is left away

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

  /// Until `to` [s], where its first command reaches it: a car that was measured before goes on as it was.
  void keep(double to) {
    if (span_.measured && later(to, span_.measured->t) && later(to, span_.start)) {
      const double from = std::max(span_.measured->t, span_.start);
      state_.speed = span_.measured->speed;
      set_ = true;
      pieces_.add(from, with_rest(car_twist(car_, state_), 0.5 * (from + to)), to - from);
    }
  }
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

/// Where the first and the last of the knots are that are met between `low` and `high`.
std::pair<Eigen::Index, Eigen::Index> knots_between(const KnotCurve& curve, double low, double high) {
  const auto first = std::ranges::upper_bound(curve.at, low) - curve.at.begin();
  const auto last = std::ranges::lower_bound(curve.at, high) - curve.at.begin();
  return {std::max<Eigen::Index>(first - 1, 0), std::min<Eigen::Index>(last, std::ssize(curve.at) - 1)};
}

void set_numbers(CarCurves& car, const Eigen::VectorXd& numbers) {
  const Eigen::Index speeds = std::ssize(car.speed.value), curvatures = std::ssize(car.curvature.value);
  std::ranges::copy(numbers.head(speeds), car.speed.value.begin());
  std::ranges::copy(numbers.segment(speeds, curvatures), car.curvature.value.begin());
  car.lag = numbers[speeds + curvatures];
  car.steering_lag = numbers[speeds + curvatures + 1];
  car.cornering_drag = numbers[speeds + curvatures + 2];
  car.understeer = numbers[speeds + curvatures + 3];
  car.delay = numbers[speeds + curvatures + 4];
}

/// Precision of the prior of a curve's values at `at`, and of a number after them, from their standard deviations:
/// increments from knot to knot are independent, going away from zero. Empty where the prior is not stated.
Eigen::MatrixXd prior_precision(const std::vector<double>& at, const Eigen::VectorXd& prior) {
  const Eigen::Index knots = std::ssize(at);
  Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(knots + 1, knots + 1);
  const auto add = [&precision](Eigen::Index far, Eigen::Index near, double variance) {
    precision(far, far) += 1.0 / variance;
    if (near >= 0) {
      precision(near, near) += 1.0 / variance;
      precision(far, near) -= 1.0 / variance;
      precision(near, far) -= 1.0 / variance;
    }
  };
  for (Eigen::Index k = 0; k < knots; ++k) {
    const double x = at[static_cast<std::size_t>(k)];
    Eigen::Index near = x > 0.0 ? k - 1 : k + 1;
    if (x == 0.0 || near < 0 || near == knots || at[static_cast<std::size_t>(near)] * x < 0.0) {
      near = -1;
    }
    const double variance = prior[k] * prior[k] - (near >= 0 ? prior[near] * prior[near] : 0.0);
    if (variance > 0.0) {
      add(k, near, variance);
    } else if (x != 0.0) {  // at zero, a value may be given
      return {};
    }
  }
  if (!(prior[knots] > 0.0)) {
    return {};
  }
  add(knots, -1, prior[knots] * prior[knots]);
  return precision;
}

/// Which of a car's numbers are times: lag, steering lag and delay, where `single` is the first that is of no curve.
std::array<Eigen::Index, 3> times_of(Eigen::Index single) { return {single, single + 1, single + 4}; }

/// What of the covariance is the prior's: large where the car never drove, and small against what the noise of the
/// measurements leaves where it did.
Eigen::MatrixXd unknown_covariance(const CarCurves& car) {
  const Eigen::MatrixXd& covariance = car.spread->covariance;
  const Eigen::VectorXd& prior = car.spread->prior_std;
  const Eigen::Index speeds = std::ssize(car.speed.at), curvatures = std::ssize(car.curvature.at);
  const Eigen::Index single = speeds + curvatures;
  Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(covariance.rows(), covariance.cols());
  const auto put = [&](const KnotCurve& curve, Eigen::Index first, Eigen::Index last) {
    const Eigen::Index size = std::ssize(curve.at);
    Eigen::VectorXd own(size + 1);
    own << prior.segment(first, size), prior[last];
    const Eigen::MatrixXd found = prior_precision(curve.at, own);
    if (found.size() > 0) {
      precision.block(first, first, size, size) = found.topLeftCorner(size, size);
      precision(last, last) = found(size, size);
    }
  };
  put(car.speed, 0, single + 2);
  put(car.curvature, speeds, single + 3);
  for (const Eigen::Index time : times_of(single)) {
    precision(time, time) = prior[time] > 0.0 ? 1.0 / (prior[time] * prior[time]) : 0.0;
  }
  return covariance * precision * covariance;
}

/// [s] after which a car has forgotten its earlier commands.
double settling(const CarCurves& car) { return 10.0 * std::max(car.lag, car.steering_lag) + car.delay + 1.0; }

}  // namespace

Eigen::VectorXd car_numbers(const CarCurves& car) {
  const Eigen::Index speeds = std::ssize(car.speed.value), curvatures = std::ssize(car.curvature.value);
  Eigen::VectorXd numbers(speeds + curvatures + 5);
  std::ranges::copy(car.speed.value, numbers.begin());
  std::ranges::copy(car.curvature.value, numbers.begin() + speeds);
  numbers.tail<5>() << car.lag, car.steering_lag, car.cornering_drag, car.understeer, car.delay;
  return numbers;
}

CarDeviations car_deviations(const CarCurves& car, const InputHistory& commands) {
  CarDeviations found{.cars = {}, .step = kDeviation};
  if (car.spread == nullptr) {
    return found;
  }
  BodyTwist low{}, high{};
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const BodyTwist command = commands.sample(i);
    low = {.v = std::min(low.v, command.v), .vy = 0.0, .omega = std::min(low.omega, command.omega)};
    high = {.v = std::max(high.v, command.v), .vy = 0.0, .omega = std::max(high.omega, command.omega)};
  }
  const Eigen::VectorXd mean = car_numbers(car);
  const Eigen::MatrixXd unknown = unknown_covariance(car);
  const Eigen::Index speeds = std::ssize(car.speed.value), single = mean.size() - 5;
  const auto [first_speed, last_speed] = knots_between(car.speed, low.v, high.v);
  const auto [first_turn, last_turn] = knots_between(car.curvature, low.omega, high.omega);
  const std::array<Eigen::Index, 3> times = times_of(single);
  std::array<std::vector<Eigen::Index>, 3> blocks{{{single + 2}, {single + 3}, {times.begin(), times.end()}}};
  for (Eigen::Index k = first_speed; k <= last_speed; ++k) {
    blocks[0].push_back(k);
  }
  for (Eigen::Index k = first_turn; k <= last_turn; ++k) {
    blocks[1].push_back(speeds + k);
  }
  for (const std::vector<Eigen::Index>& block : blocks) {
    const Eigen::Index size = std::ssize(block);
    Eigen::MatrixXd covariance(size, size);
    for (Eigen::Index i = 0; i < size; ++i) {
      for (Eigen::Index k = 0; k < size; ++k) {
        covariance(i, k) = unknown(block[static_cast<std::size_t>(i)], block[static_cast<std::size_t>(k)]);
      }
    }
    const SymmetricEigen directions = symmetric_eigen(covariance);
    const double least = std::max(kNegligible * directions.values[size - 1], 0.0);
    for (Eigen::Index i = 0; i < size; ++i) {
      if (directions.values[i] > least) {
        Eigen::VectorXd numbers = mean;
        for (Eigen::Index k = 0; k < size; ++k) {
          numbers[block[static_cast<std::size_t>(k)]] +=
              kDeviation * std::sqrt(directions.values[i]) * directions.vectors(k, i);
        }
        for (const Eigen::Index time : times) {
          numbers[time] = std::max(numbers[time], 0.0);
        }
        set_numbers(found.cars.emplace_back(car), numbers);
      }
    }
  }
  return found;
}

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
  if (commands.size() > 0) {
    drive.keep(std::min(commands.time(0) + car.delay, span.end));
  }
  for (std::size_t i = 0; i < commands.size() && commands.time(i) + car.delay < span.end; ++i) {
    const double next = i + 1 < commands.size() ? std::min(commands.time(i + 1) + car.delay, span.end) : span.end;
    if (next > begin) {
      drive.hold(commands.sample(i), std::max(commands.time(i) + car.delay, begin), next);
    }
  }
  return std::move(drive).inputs();
}

}  // namespace slipwise
