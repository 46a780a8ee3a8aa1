// SPDX-License-Identifier: Apache-2.0
// Each rollout's car goes through its curves by itself; steps are as those of a car's twists.
#include "slipwise/rollout/car_batch.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

namespace slipwise {
namespace {

constexpr double kLongest = 0.02;     // [s] of a step; over it the yaw rate in the drag is held
constexpr double kStandstill = 0.05;  // [m/s] below which a yaw rate tells nothing of the steering
constexpr int kHalvings = 40;

/// The mean twist over a period, and the car after it.
std::pair<BodyTwist, CarState> driven(const CarCurves& car, CarState state, const BodyTwist& command, double period) {
  const auto steps = std::max(1.0, std::ceil(period / kLongest - 1e-9));
  BodyTwist mean;
  for (int i = 0; i < static_cast<int>(steps); ++i) {
    const CarState before = state;
    state = advanced(car, state, command, period / steps);
    const BodyTwist twist = car_twist(
        car, {.speed = 0.5 * (before.speed + state.speed), .steering = 0.5 * (before.steering + state.steering)});
    mean.v += twist.v / steps;
    mean.omega += twist.omega / steps;
  }
  return {mean, state};
}

/// The steering at which the car turns as it does; its curve does not fall.
double steering_of(const CarCurves& car, const DriveCommand& drive) {
  if (std::abs(drive.v) < kStandstill) {
    return 0.0;
  }
  const double wanted = drive.omega / drive.v * (1.0 + car.understeer * drive.v * drive.v);
  double low = -1.0, high = 1.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (car.curvature(middle) < wanted ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

template <typename Scalar>
CarBatch<Scalar> car_batch(const CarCurves& car, const RolloutBatch<Scalar>& batch, double period) {
  const std::size_t starts = batch.starts.size();
  if ((starts != 1 && starts != batch.rollouts) || batch.past.size() % starts != 0 || !(period > 0.0)) {
    throw std::invalid_argument("a car's rollouts need one start, or one each, and a positive period");
  }
  const std::size_t size = batch.rollouts * batch.periods, sent = batch.past.size() / starts;
  CarBatch<Scalar> result{std::vector<Scalar>(size), std::vector<Scalar>(size), {}};
  std::vector<CarState> begin;
  for (std::size_t i = 0; i < starts; ++i) {
    const DriveCommand& drive = batch.starts[i].drive;
    CarState state{.speed = drive.v, .steering = sent > 0 ? batch.past[i * sent].omega : steering_of(car, drive)};
    for (std::size_t k = 0; k < sent; ++k) {
      const DriveCommand& command = batch.past[i * sent + k];
      const auto [twist, after] = driven(car, state, {.v = command.v, .vy = 0.0, .omega = command.omega}, period);
      const BodyTwist at_speed = car_twist(car, {.speed = drive.v, .steering = after.steering});
      result.past.push_back({.v = at_speed.v, .omega = at_speed.omega});
      state = {.speed = drive.v, .steering = after.steering};
    }
    begin.push_back(state);
  }
  for (std::size_t i = 0; i < batch.rollouts; ++i) {
    CarState state = begin[starts == 1 ? 0 : i];
    for (std::size_t k = 0; k < batch.periods; ++k) {
      const std::ptrdiff_t place = static_cast<std::ptrdiff_t>(i) * batch.commands.rollout_stride +
                                   static_cast<std::ptrdiff_t>(k) * batch.commands.period_stride;
      const BodyTwist command{.v = static_cast<double>(batch.commands.v[place]),
                              .vy = 0.0,
                              .omega = static_cast<double>(batch.commands.omega[place])};
      const auto [twist, after] = driven(car, state, command, period);
      result.v[k * batch.rollouts + i] = static_cast<Scalar>(twist.v);
      result.omega[k * batch.rollouts + i] = static_cast<Scalar>(twist.omega);
      state = after;
    }
  }
  return result;
}

template CarBatch<float> car_batch(const CarCurves&, const RolloutBatch<float>&, double);
template CarBatch<double> car_batch(const CarCurves&, const RolloutBatch<double>&, double);

}  // namespace slipwise
