// SPDX-License-Identifier: Apache-2.0
// Weights of ramps are increments of a curve; the likelihoods of its candidates say how sure the lags are.
#include "slipwise/identify/car_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "slipwise/identify/lag_variance.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

constexpr double kUnsteep = 0.05;   // [m/s] that a ramp may differ from the prior's however flat that is
constexpr double kOffsetStd = 0.1;  // of the curvature straight ahead, as a fraction of the full one
constexpr double kCurvatureStd = 0.8;
constexpr std::array kDragPrior{0.05, 0.3};        // mean and std [s/rad]
constexpr std::array kUndersteerPrior{0.02, 0.2};  // [s^2/m^2]
SLIPWISE_TUNING(kDelayed, 10.0);  // logarithm of the odds of no delay, which noise of few twists would feign

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

const Eigen::MatrixXd& values_by_speed() {
  static const Eigen::MatrixXd values = values_by_weights(kCarThrottle, false);
  return values;
}

const Eigen::MatrixXd& values_by_turn() {
  static const Eigen::MatrixXd values = values_by_weights(kCarSteering, true);
  return values;
}

/// The candidates of a bank: lags, side by side for each delay.
Eigen::MatrixXd by_delay(const CurveBank& bank) {
  return bank.log_likelihoods().reshaped(Eigen::AutoSize, std::ssize(kCarDelays));
}

/// What throttle and steering tell of the lags and of their common delay.
struct CarTimes {
  Eigen::MatrixXd speed, turn;  ///< logarithms of the likelihoods [lags, delays]
  Eigen::VectorXd delays;       ///< the same of the delays, each with the lags that suit it best
  Eigen::Index delay = 0, lag = 0, steering_lag = 0;

  CarTimes(const CurveBank& speeds, const CurveBank& turns) : speed(by_delay(speeds)), turn(by_delay(turns)) {
    delays = (speed.colwise().maxCoeff() + turn.colwise().maxCoeff()).transpose();
    delays.tail(delays.size() - 1).array() -= kDelayed;
    delays.maxCoeff(&delay);
    speed.col(delay).maxCoeff(&lag);
    turn.col(delay).maxCoeff(&steering_lag);
  }
  std::size_t speed_candidate() const { return static_cast<std::size_t>(delay * speed.rows() + lag); }
  std::size_t turn_candidate() const { return static_cast<std::size_t>(delay * turn.rows() + steering_lag); }
};

/// What speeds and turns tell is independent of each other, and of the lags.
CarSpread car_spread(const CurveBank& speed, const CurveBank& turn, const CarTimes& times) {
  const Eigen::MatrixXd &by_speed = values_by_speed(), &by_turn = values_by_turn();
  const Eigen::Index speeds = by_speed.rows() - 1, curvatures = by_turn.rows() - 1, single = speeds + curvatures;
  CarSpread spread{.covariance = Eigen::MatrixXd::Zero(single + 5, single + 5),
                   .prior_std = Eigen::VectorXd::Zero(single + 5)};
  const auto put = [&spread](const Eigen::MatrixXd& by_weights, const CurveBank& bank, std::size_t candidate,
                             Eigen::Index first, Eigen::Index last) {
    // Of a curve's values from `first` on, and the number at `last`.
    const Eigen::Index size = by_weights.rows() - 1;
    const Eigen::MatrixXd found = by_weights * bank.covariance(candidate) * by_weights.transpose();
    spread.covariance.block(first, first, size, size) = found.topLeftCorner(size, size);
    spread.covariance.block(first, last, size, 1) = found.topRightCorner(size, 1);
    spread.covariance.block(last, first, 1, size) = found.bottomLeftCorner(1, size);
    spread.covariance(last, last) = found(size, size);
    const Eigen::VectorXd prior =
        (by_weights * bank.prior_covariance() * by_weights.transpose()).diagonal().cwiseSqrt();
    spread.prior_std.segment(first, size) = prior.head(size);
    spread.prior_std[last] = prior[size];
  };
  put(by_speed, speed, times.speed_candidate(), 0, single + 2);
  put(by_turn, turn, times.turn_candidate(), speeds, single + 3);
  // A lag too long goes with a delay too short: none is known better than the delay.
  const double of_delay = lag_variance(kCarDelays, times.delays, static_cast<std::size_t>(times.delay));
  const auto put_lag = [&](std::span<const double> lags, const Eigen::MatrixXd& likely, Eigen::Index best,
                           Eigen::Index at) {
    spread.covariance(at, at) = of_delay + lag_variance(lags, likely.col(times.delay), static_cast<std::size_t>(best));
    spread.prior_std[at] = std::sqrt(prior_lag_variance(lags));
    spread.covariance(at, single + 4) = spread.covariance(single + 4, at) = -of_delay;
  };
  put_lag(kCarLags, times.speed, times.lag, single);
  put_lag(kCarSteeringLags, times.turn, times.steering_lag, single + 1);
  spread.covariance(single, single + 1) = spread.covariance(single + 1, single) = of_delay;
  spread.covariance(single + 4, single + 4) = of_delay;
  spread.prior_std[single + 4] = std::sqrt(prior_lag_variance(kCarDelays));
  return spread;
}

}  // namespace

Eigen::VectorXd throttle_ramps(double throttle) { return ramps(kCarThrottle, throttle); }
Eigen::VectorXd steering_ramps(double steering) { return ramps(kCarSteering, steering); }

CurveBank car_speed_bank(double top_speed, double noise) {
  Eigen::VectorXd mean(kThrottleRamps + 1), std(kThrottleRamps + 1);
  mean << top_speed * widths(kCarThrottle), kDragPrior[0];
  std << (top_speed * widths(kCarThrottle)).array() + kUnsteep, kDragPrior[1];
  return {kCarLags.size() * kCarDelays.size(), mean, std, noise, 0};
}

CurveBank car_turn_bank(double curvature, double noise) {
  Eigen::VectorXd mean(kSteeringRamps + 2), std(kSteeringRamps + 2);
  mean << 0.0, curvature * widths(kCarSteering), kUndersteerPrior[0];
  std << kOffsetStd * curvature, kCurvatureStd * curvature * widths(kCarSteering), kUndersteerPrior[1];
  return {kCarSteeringLags.size() * kCarDelays.size(), mean, std, noise, 1};
}

CarCurves car_of_candidates(const CurveBank& speed, const CurveBank& turn) {
  const CarTimes times(speed, turn);
  const Eigen::VectorXd fast = values_by_speed() * speed.weights(times.speed_candidate());
  const Eigen::VectorXd sharp = values_by_turn() * turn.weights(times.turn_candidate());
  const auto spread = std::make_shared<const CarSpread>(car_spread(speed, turn, times));
  const Eigen::Index speeds = fast.size() - 1, curvatures = sharp.size() - 1;
  const Eigen::MatrixXd& covariance = spread->covariance;
  return {
      .speed = curve_of(both_sides(kCarThrottle), fast, covariance.topLeftCorner(speeds, speeds)),
      .curvature = curve_of(both_sides(kCarSteering), sharp, covariance.block(speeds, speeds, curvatures, curvatures)),
      .lag = kCarLags[static_cast<std::size_t>(times.lag)],
      .steering_lag = kCarSteeringLags[static_cast<std::size_t>(times.steering_lag)],
      .cornering_drag = fast[speeds],
      .understeer = sharp[curvatures],
      .delay = kCarDelays[static_cast<std::size_t>(times.delay)],
      .spread = spread};
}

}  // namespace slipwise
