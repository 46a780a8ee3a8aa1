// SPDX-License-Identifier: Apache-2.0
// Lagging ramps of the throttle explain the speed, ramps of the lagging steering the yaw rate.
#include "slipwise/identify/car_curve_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "slipwise/actuator/first_order_lag.hpp"
#include "slipwise/identify/car_candidates.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

constexpr std::array kGains{0.0, 0.25, 0.5, 0.75, 1.0};  // of a measured speed over the one that is followed
SLIPWISE_TUNING(kSpeedNoise, 0.1);                       // [m/s] of a mean speed about the curve, before it is learned
SLIPWISE_TUNING(kTurnNoise, 0.1);                        // [rad/s]
constexpr std::array kRestLags{0.0, 0.1, 0.25, 0.6, 1.5};  // [s]
constexpr std::size_t kRestTwists = 3;  // from the one that was left over to the one that it is held against
constexpr double kGainExamples = 1.0;   // at full throttle and steering, that the gains given are worth
constexpr double kBeyond = 3.0;         // times the top speed and the tightest turn no car moves
constexpr std::size_t kSolveEvery = 5;  // twists

/// Calls `act` with each command that reaches a car over [from, to] [s], `delay` after it was given, and for how long.
template <class Act>
void each_hold(const InputHistory& commands, double delay, double from, double to, const Act& act) {
  constexpr double kLongest = 0.05;  // [s] of a step
  double now = from;
  std::size_t next = commands.count_until(now - delay);
  while (now < to) {
    const double change = next < commands.size() ? commands.time(next) + delay : to;
    const double end = std::min({to, std::max(change, now), now + kLongest});
    if (end > now) {
      act(next > 0 ? commands.sample(next - 1) : BodyTwist{}, end - now);
      now = end;
    }
    next += next < commands.size() && change <= now ? 1 : 0;
  }
}

/// A lag's output and the sum of it over a step.
void lag_on(double& state, double input, const LagDecay& decay, double& sum) {
  const LagStep done = linearize_lag_step(state, input, decay).value;
  state = done.output;
  sum += done.integral;
}

/// Poses that jump would leave a yaw rate and a speed whose product outweighs all others.
bool plausible(const CarCurves& car, const BodyTwist& twist) {
  const auto largest = [](const KnotCurve& curve) {
    return std::max(std::abs(curve.value.front()), std::abs(curve.value.back()));
  };
  const double speed = kBeyond * largest(car.speed);
  return std::abs(twist.v) <= speed && std::abs(twist.omega) <= speed * largest(car.curvature);
}

}  // namespace

RestFilter::RestFilter() : score_(kRestLags.size(), 0.0) {}

void RestFilter::learn(double t, double rest, double noise) {
  past_.emplace_back(t, rest);
  if (past_.size() <= kRestTwists) {
    return;
  }
  const auto [since, before] = past_.front();
  past_.pop_front();
  for (std::size_t i = 0; i < kRestLags.size(); ++i) {
    score_[i] += huber_square((rest - lag_output(before, 0.0, kRestLags[i], t - since)) / noise);
  }
}

double RestFilter::lag() const {
  return kRestLags[static_cast<std::size_t>(std::ranges::min_element(score_) - score_.begin())];
}

/// Sums of the features over the time since the last twist, in seconds of them.
struct CarCurveFilter::Means {
  Eigen::MatrixXd ramps = Eigen::MatrixXd::Zero(kThrottleRamps, std::ssize(kCarLags) * std::ssize(kCarDelays));
  Eigen::VectorXd drags = Eigen::VectorXd::Zero(std::ssize(kCarLags));
  Eigen::MatrixXd steering =
      Eigen::MatrixXd::Zero(kSteeringRamps, std::ssize(kCarSteeringLags) * std::ssize(kCarDelays));
  std::array<double, kGains.size()> distance{};
  BodyTwist commanded{};  ///< throttle, and throttle times steering
  double seconds = 0.0;
};

CarCurveFilter::CarCurveFilter(const CarPrior& prior)
    : speed_(car_speed_bank(prior.top_speed, kSpeedNoise)),
      turn_(car_turn_bank(prior.curvature, kTurnNoise)),
      observer_score_(kGains.size(), 0.0) {
  gain_ = {.products = kGainExamples * prior.top_speed, .squares = kGainExamples};
  turn_gain_ = {.products = kGainExamples * prior.top_speed * prior.curvature, .squares = kGainExamples};
  start_run(0.0);
  set_curves();
}

CarCurveFilter::CarCurveFilter(const CarPrior& prior, const CarCurves& known) : CarCurveFilter(prior) {
  curves_ = known;
  known_ = true;
}

void CarCurveFilter::start_run(double t) {
  speed_.start_run();
  turn_.start_run();
  ramps_ = Eigen::MatrixXd::Zero(kThrottleRamps, std::ssize(kCarLags) * std::ssize(kCarDelays));
  drags_ = Eigen::VectorXd::Zero(std::ssize(kCarLags));
  steering_ = Eigen::VectorXd::Zero(std::ssize(kCarSteeringLags) * std::ssize(kCarDelays));
  observers_.assign(kGains.size(), {});
  turn_rest_.start_run();
  sideways_.start_run();
  until_ = t;
  held_ = {};
}

void CarCurveFilter::follow_candidates(std::size_t delay, const BodyTwist& command, double duration, Means& means) {
  const Eigen::VectorXd up = throttle_ramps(command.v);
  for (std::size_t i = 0; i < kCarLags.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(delay * kCarLags.size() + i);
    const LagDecay decay(kCarLags[i], duration);
    for (Eigen::Index r = 0; r < kThrottleRamps; ++r) {
      lag_on(ramps_(r, k), up[r], decay, means.ramps(r, k));
    }
  }
  for (std::size_t i = 0; i < kCarSteeringLags.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(delay * kCarSteeringLags.size() + i);
    const double before = steering_[k];
    steering_[k] = lag_output(before, command.omega, kCarSteeringLags[i], duration);
    means.steering.col(k) += duration * steering_ramps(0.5 * (before + steering_[k]));
  }
}

void CarCurveFilter::follow_car(const BodyTwist& command, double duration, Means& means) {
  for (std::size_t i = 0; i < observers_.size(); ++i) {
    const double before = observers_[i].speed;
    observers_[i] = advanced(curves_, observers_[i], command, duration);
    means.distance[i] += 0.5 * duration * (before + observers_[i].speed);
  }
  const double drag = std::abs(held_.omega * held_.v);
  for (std::size_t i = 0; i < kCarLags.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    lag_on(drags_[k], drag, LagDecay(kCarLags[i], duration), means.drags[k]);
  }
  means.seconds += duration;
}

void CarCurveFilter::follow(const InputHistory& commands, double until, const BodyTwist* twist) {
  if (!(until > until_)) {
    return;
  }
  if (twist != nullptr && !plausible(lasting_, *twist)) {
    twist = nullptr;
  }
  if (twist != nullptr) {
    held_ = *twist;
  }
  Means means;
  for (std::size_t i = 0; i < kCarDelays.size(); ++i) {
    each_hold(commands, kCarDelays[i], until_, until,
              [&](const BodyTwist& command, double duration) { follow_candidates(i, command, duration, means); });
  }
  each_hold(commands, 0.0, until_, until, [&](const BodyTwist& command, double duration) {
    means.commanded.v += duration * command.v;
    means.commanded.omega += duration * command.v * command.omega;
  });
  each_hold(commands, curves_.delay, until_, until,
            [&](const BodyTwist& command, double duration) { follow_car(command, duration, means); });
  until_ = until;
  if (twist != nullptr) {
    learn(means, *twist);
  }
}

void CarCurveFilter::learn(const Means& means, const BodyTwist& twist) {
  Eigen::MatrixXd speed(means.ramps.cols(), kThrottleRamps + 1);
  speed << means.ramps.transpose(), -means.drags.replicate(std::ssize(kCarDelays), 1);
  speed_.learn(speed / means.seconds, twist.v);
  Eigen::MatrixXd turn(means.steering.cols(), kSteeringRamps + 2);
  turn.col(0).setConstant(twist.v);
  turn.middleCols(1, kSteeringRamps) = twist.v / means.seconds * means.steering.transpose();
  turn.col(kSteeringRamps + 1).setConstant(-twist.v * twist.v * twist.omega);
  turn_.learn(turn, twist.omega);
  for (std::size_t i = 0; i < observers_.size(); ++i) {
    const double error = twist.v - means.distance[i] / means.seconds;
    observer_score_[i] += huber_square(error / kSpeedNoise);
    observers_[i].speed += kGains[i] * error;
  }
  gain_.learn(means.commanded.v / means.seconds, twist.v);
  turn_gain_.learn(means.commanded.omega / means.seconds, twist.omega);
  const CarState now{.speed = twist.v, .steering = observers_.front().steering};
  turn_rest_.learn(until_, twist.omega - car_twist(curves_, now).omega, kTurnNoise);
  sideways_.learn(until_, twist.vy, kSpeedNoise);
  if (++learned_ % kSolveEvery == 0 && !known_) {
    set_curves();
  }
}

void CarCurveFilter::set_curves() {
  speed_.solve();
  turn_.solve();
  curves_ = car_of_candidates(speed_.heaviest(), turn_.heaviest());
  const CurveBank &speed = speed_.copies()[0], &turn = turn_.copies()[0];
  lasting_ = &speed == &speed_.heaviest() && &turn == &turn_.heaviest() ? curves_ : car_of_candidates(speed, turn);
}

CarCurves CarCurveFilter::straight() const {
  const double speed = gain_.value(), curvature = speed > 0.0 ? turn_gain_.value() / speed : 0.0;
  return {.speed = {.at = {-1.0, 1.0}, .value = {-speed, speed}, .std = {0.0, 0.0}},
          .curvature = {.at = {-1.0, 1.0}, .value = {-curvature, curvature}, .std = {0.0, 0.0}}};
}

double CarCurveFilter::reach() { return kCarDelays.back(); }

std::size_t CarCurveFilter::best_observer() const {
  return static_cast<std::size_t>(std::ranges::min_element(observer_score_) - observer_score_.begin());
}

KnownMotion CarCurveFilter::motion() const {
  return {.t = until_,
          .speed = observers_[best_observer()].speed,
          .turn = turn_rest_.rest(),
          .turn_lag = turn_rest_.lag(),
          .sideways = sideways_.rest(),
          .sideways_lag = sideways_.lag()};
}

KnownMotion CarCurveFilter::motion(const InputHistory& commands, double t, const BodyTwist& twist,
                                   double weight) const {
  const std::size_t best = best_observer();
  CarState state = observers_[best];
  double distance = 0.0;
  each_hold(commands, curves_.delay, until_, t, [&](const BodyTwist& command, double duration) {
    const double before = state.speed;
    state = advanced(curves_, state, command, duration);
    distance += 0.5 * duration * (before + state.speed);
  });
  const double seconds = t - until_, counted = plausible(lasting_, twist) ? weight : 0.0;
  const double turn = twist.omega - car_twist(curves_, {.speed = twist.v, .steering = state.steering}).omega;
  KnownMotion now = motion();
  const auto followed = [&](double before, double lag, double measured) {
    const double left = lag_output(before, 0.0, lag, seconds);
    return left + counted * (measured - left);
  };
  now.t = t;
  now.speed = state.speed + counted * kGains[best] * (twist.v - distance / seconds);
  now.turn = followed(now.turn, now.turn_lag, turn);
  now.sideways = followed(now.sideways, now.sideways_lag, twist.vy);
  return now;
}

}  // namespace slipwise
