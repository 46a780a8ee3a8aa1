// SPDX-License-Identifier: Apache-2.0
// Lagging ramps of the throttle explain the speed, ramps of the lagging steering the yaw rate.
#include "slipwise/identify/car_curve_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

#include "slipwise/actuator/first_order_lag.hpp"
#include "slipwise/identify/lag_variance.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

constexpr std::array kThrottle{0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6, 0.8, 1.0};
constexpr std::array kSteering{0.0, 0.2, 0.4, 0.6, 0.8, 1.0};
constexpr std::array kLags{0.0, 0.1, 0.2, 0.4, 0.7, 1.2, 2.0};  // [s]
constexpr std::array kSteeringLags{0.0, 0.05, 0.1, 0.2, 0.35};  // [s]
constexpr std::array kGains{0.0, 0.25, 0.5, 0.75, 1.0};         // of a measured speed over the one that is followed
constexpr Eigen::Index kThrottleRamps = 2 * (std::ssize(kThrottle) - 1);
constexpr Eigen::Index kSteeringRamps = 2 * (std::ssize(kSteering) - 1);
SLIPWISE_TUNING(kSpeedNoise, 0.1);  // [m/s] of a mean speed about the curve, before it is learned
SLIPWISE_TUNING(kTurnNoise, 0.1);   // [rad/s]
constexpr double kUnsteep = 0.05;   // [m/s] that a ramp may differ from the prior's however flat that is
constexpr double kOffsetStd = 0.1;  // of the curvature straight ahead, as a fraction of the full one
constexpr double kCurvatureStd = 0.8;
constexpr std::array kDragPrior{0.05, 0.3};                // mean and std [s/rad]
constexpr std::array kUndersteerPrior{0.02, 0.2};          // [s^2/m^2]
constexpr std::array kRestLags{0.0, 0.1, 0.25, 0.6, 1.5};  // [s]
constexpr std::size_t kRestTwists = 3;  // from the one that was left over to the one that it is held against
constexpr double kGainExamples = 1.0;   // at full throttle and steering, that the gains given are worth
constexpr double kBeyond = 3.0;         // times the top speed and the tightest turn no car moves
constexpr std::size_t kSolveEvery = 5;  // twists

/// How far x is up each ramp between knots on its own side of zero; on the other side ramps go down.
template <std::size_t N>
Eigen::VectorXd ramps(const std::array<double, N>& knots, double x) {
  constexpr auto kCount = static_cast<Eigen::Index>(N) - 1;
  Eigen::VectorXd up(2 * kCount);
  for (std::size_t i = 0; i + 1 < N; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double width = knots[i + 1] - knots[i];
    up[k] = std::clamp((x - knots[i]) / width, 0.0, 1.0);
    up[kCount + k] = -std::clamp((-x - knots[i]) / width, 0.0, 1.0);
  }
  return up;
}

/// Knots on both sides of zero, in order.
template <std::size_t N>
std::vector<double> both_sides(const std::array<double, N>& knots) {
  std::vector<double> at;
  for (std::size_t i = N - 1; i > 0; --i) {
    at.push_back(-knots[i]);
  }
  at.insert(at.end(), knots.begin(), knots.end());
  return at;
}

/// How values of a curve at all its knots follow from weights: an offset at zero, where there is one, and increments
/// over the ramps. The last weight is no part of the curve: it is handed on as it is.
template <std::size_t N>
Eigen::MatrixXd values_by_weights(const std::array<double, N>& knots, bool offset) {
  const std::vector<double> at = both_sides(knots);
  const Eigen::Index count = std::ssize(at), first = offset ? 1 : 0;
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(count + 1, first + count);
  for (Eigen::Index k = 0; k < count; ++k) {
    rows.row(k).head(first).setOnes();
    rows.row(k).segment(first, count - 1) = ramps(knots, at[static_cast<std::size_t>(k)]).transpose();
  }
  rows(count, first + count - 1) = 1.0;
  return rows;
}

/// A curve from its values at the knots, and a number after them that it does not take.
KnotCurve curve_of(std::vector<double> at, const Eigen::VectorXd& values, const Eigen::MatrixXd& covariance) {
  KnotCurve curve{.at = std::move(at), .value = {}, .std = {}};
  for (Eigen::Index k = 0; k < std::ssize(curve.at); ++k) {
    curve.value.push_back(values[k]);
    curve.std.push_back(std::sqrt(std::max(covariance(k, k), 0.0)));
  }
  return curve;
}

template <std::size_t N>
Eigen::VectorXd widths(const std::array<double, N>& knots) {
  constexpr auto kCount = static_cast<Eigen::Index>(N) - 1;
  Eigen::VectorXd both(2 * kCount);
  for (std::size_t i = 0; i + 1 < N; ++i) {
    both[static_cast<Eigen::Index>(i)] = both[kCount + static_cast<Eigen::Index>(i)] = knots[i + 1] - knots[i];
  }
  return both;
}

CurveBank speed_bank(const CarPrior& prior) {
  Eigen::VectorXd mean(kThrottleRamps + 1), std(kThrottleRamps + 1);
  mean << prior.top_speed * widths(kThrottle), kDragPrior[0];
  std << (prior.top_speed * widths(kThrottle)).array() + kUnsteep, kDragPrior[1];
  return {kLags.size(), mean, std, kSpeedNoise, 0};
}

CurveBank turn_bank(const CarPrior& prior) {
  Eigen::VectorXd mean(kSteeringRamps + 2), std(kSteeringRamps + 2);
  mean << 0.0, prior.curvature * widths(kSteering), kUndersteerPrior[0];
  std << kOffsetStd * prior.curvature, kCurvatureStd * prior.curvature * widths(kSteering), kUndersteerPrior[1];
  return {kSteeringLags.size(), mean, std, kTurnNoise, 1};
}

/// Calls `act` with each command that is held over [from, to] [s], and for how long.
template <class Act>
void each_hold(const InputHistory& commands, double from, double to, const Act& act) {
  constexpr double kLongest = 0.05;  // [s] of a step
  double now = from;
  std::size_t next = commands.count_until(now);
  while (now < to) {
    const double change = next < commands.size() ? commands.time(next) : to;
    const double end = std::min({to, std::max(change, now), now + kLongest});
    if (end > now) {
      act(next > 0 ? commands.sample(next - 1) : BodyTwist{}, end - now);
      now = end;
    }
    next += next < commands.size() && change <= now ? 1 : 0;
  }
}

/// Poses that jump would leave a yaw rate and a speed whose product outweighs all others.
bool plausible(const CarCurves& car, const BodyTwist& twist) {
  const auto largest = [](const KnotCurve& curve) {
    return std::max(std::abs(curve.value.front()), std::abs(curve.value.back()));
  };
  const double speed = kBeyond * largest(car.speed);
  return std::abs(twist.v) <= speed && std::abs(twist.omega) <= speed * largest(car.curvature);
}

const Eigen::MatrixXd& values_by_speed() {
  static const Eigen::MatrixXd values = values_by_weights(kThrottle, false);
  return values;
}

const Eigen::MatrixXd& values_by_turn() {
  static const Eigen::MatrixXd values = values_by_weights(kSteering, true);
  return values;
}

/// What speeds and turns tell is independent of each other, and of the lags.
CarSpread car_spread(const CurveBank& speed, const CurveBank& turn) {
  const Eigen::MatrixXd &by_speed = values_by_speed(), &by_turn = values_by_turn();
  const Eigen::Index speeds = by_speed.rows() - 1, curvatures = by_turn.rows() - 1, single = speeds + curvatures;
  CarSpread spread{.covariance = Eigen::MatrixXd::Zero(single + 4, single + 4),
                   .prior_std = Eigen::VectorXd::Zero(single + 4)};
  const auto put = [&spread](const Eigen::MatrixXd& by_weights, const CurveBank& bank, Eigen::Index first,
                             Eigen::Index last) {  // of a curve's values from `first` on, and the number at `last`
    const Eigen::Index size = by_weights.rows() - 1;
    const Eigen::MatrixXd found = by_weights * bank.covariance() * by_weights.transpose();
    spread.covariance.block(first, first, size, size) = found.topLeftCorner(size, size);
    spread.covariance.block(first, last, size, 1) = found.topRightCorner(size, 1);
    spread.covariance.block(last, first, 1, size) = found.bottomLeftCorner(1, size);
    spread.covariance(last, last) = found(size, size);
    const Eigen::VectorXd prior =
        (by_weights * bank.prior_covariance() * by_weights.transpose()).diagonal().cwiseSqrt();
    spread.prior_std.segment(first, size) = prior.head(size);
    spread.prior_std[last] = prior[size];
  };
  put(by_speed, speed, 0, single + 2);
  put(by_turn, turn, speeds, single + 3);
  spread.covariance(single, single) = lag_variance(kLags, speed.log_likelihoods(), speed.best());
  spread.covariance(single + 1, single + 1) = lag_variance(kSteeringLags, turn.log_likelihoods(), turn.best());
  spread.prior_std[single] = std::sqrt(prior_lag_variance(kLags));
  spread.prior_std[single + 1] = std::sqrt(prior_lag_variance(kSteeringLags));
  return spread;
}

CarCurves curves_of(const CurveBank& speed, const CurveBank& turn) {
  const Eigen::VectorXd fast = values_by_speed() * speed.weights(), sharp = values_by_turn() * turn.weights();
  const auto spread = std::make_shared<const CarSpread>(car_spread(speed, turn));
  const Eigen::Index speeds = fast.size() - 1, curvatures = sharp.size() - 1;
  const Eigen::MatrixXd& covariance = spread->covariance;
  return {.speed = curve_of(both_sides(kThrottle), fast, covariance.topLeftCorner(speeds, speeds)),
          .curvature = curve_of(both_sides(kSteering), sharp, covariance.block(speeds, speeds, curvatures, curvatures)),
          .lag = kLags[speed.best()],
          .steering_lag = kSteeringLags[turn.best()],
          .cornering_drag = fast[speeds],
          .understeer = sharp[curvatures],
          .spread = spread};
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
  Eigen::MatrixXd ramps = Eigen::MatrixXd::Zero(kThrottleRamps, std::ssize(kLags));
  Eigen::VectorXd drags = Eigen::VectorXd::Zero(std::ssize(kLags));
  Eigen::MatrixXd steering = Eigen::MatrixXd::Zero(kSteeringRamps, std::ssize(kSteeringLags));
  std::array<double, kGains.size()> distance{};
  BodyTwist commanded{};  ///< throttle, and throttle times steering
  double seconds = 0.0;
};

CarCurveFilter::CarCurveFilter(const CarPrior& prior)
    : speed_(speed_bank(prior)), turn_(turn_bank(prior)), observer_score_(kGains.size(), 0.0) {
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
  ramps_ = Eigen::MatrixXd::Zero(kThrottleRamps, std::ssize(kLags));
  drags_ = Eigen::VectorXd::Zero(std::ssize(kLags));
  steering_ = Eigen::VectorXd::Zero(std::ssize(kSteeringLags));
  observers_.assign(kGains.size(), {});
  turn_rest_.start_run();
  sideways_.start_run();
  until_ = t;
  held_ = {};
}

void CarCurveFilter::step(const BodyTwist& command, double duration, const BodyTwist& moved, Means& means) {
  const Eigen::VectorXd up = ramps(kThrottle, command.v);
  const double drag = std::abs(moved.omega * moved.v);
  for (std::size_t i = 0; i < kLags.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const LagDecay decay(kLags[i], duration);
    const auto advance = [&decay](double& state, double input, double& sum) {
      const LagStep done = linearize_lag_step(state, input, decay).value;
      state = done.output;
      sum += done.integral;
    };
    for (Eigen::Index r = 0; r < kThrottleRamps; ++r) {
      advance(ramps_(r, k), up[r], means.ramps(r, k));
    }
    advance(drags_[k], drag, means.drags[k]);
  }
  for (std::size_t i = 0; i < kSteeringLags.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double before = steering_[k];
    steering_[k] = lag_output(before, command.omega, kSteeringLags[i], duration);
    means.steering.col(k) += duration * ramps(kSteering, 0.5 * (before + steering_[k]));
  }
  for (std::size_t i = 0; i < observers_.size(); ++i) {
    const double before = observers_[i].speed;
    observers_[i] = advanced(curves_, observers_[i], command, duration);
    means.distance[i] += 0.5 * duration * (before + observers_[i].speed);
  }
  means.commanded.v += duration * command.v;
  means.commanded.omega += duration * command.v * command.omega;
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
  each_hold(commands, until_, until,
            [&](const BodyTwist& command, double duration) { step(command, duration, held_, means); });
  until_ = until;
  if (twist != nullptr) {
    learn(means, *twist);
  }
}

void CarCurveFilter::learn(const Means& means, const BodyTwist& twist) {
  Eigen::MatrixXd speed(std::ssize(kLags), kThrottleRamps + 1);
  speed << means.ramps.transpose(), -means.drags;
  speed_.learn(speed / means.seconds, twist.v);
  Eigen::MatrixXd turn(std::ssize(kSteeringLags), kSteeringRamps + 2);
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
  curves_ = curves_of(speed_.heaviest(), turn_.heaviest());
  const CurveBank &speed = speed_.copies()[0], &turn = turn_.copies()[0];
  lasting_ = &speed == &speed_.heaviest() && &turn == &turn_.heaviest() ? curves_ : curves_of(speed, turn);
}

CarCurves CarCurveFilter::straight() const {
  const double speed = gain_.value(), curvature = speed > 0.0 ? turn_gain_.value() / speed : 0.0;
  return {.speed = {.at = {-1.0, 1.0}, .value = {-speed, speed}, .std = {0.0, 0.0}},
          .curvature = {.at = {-1.0, 1.0}, .value = {-curvature, curvature}, .std = {0.0, 0.0}}};
}

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
  each_hold(commands, until_, t, [&](const BodyTwist& command, double duration) {
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
