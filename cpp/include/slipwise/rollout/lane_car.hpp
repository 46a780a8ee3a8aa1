// SPDX-License-Identifier: Apache-2.0
// A car commanded by throttle and steering, in lanes: the mean twist of each period.
#pragma once

#include <type_traits>

#include "slipwise/actuator/car_stages.hpp"
#include "slipwise/rollout/lane_car_job.hpp"
#include "slipwise/rollout/lanes.hpp"

// Plain arrays: the functions of std::array would be compiled for the processor of one file and called from others.
// NOLINTBEGIN(modernize-avoid-c-arrays)
namespace slipwise {

/// A curve that is straight between its knots, as a straight line and what it bends by at each of them.
template <class Vector, typename Scalar>
SLIPWISE_LANES void follow_curve(const LaneCurve<Scalar>& curve, const Vector& x, Vector& value) {
  Vector low, high;
  fill(curve.first, low);
  fill(curve.last, high);
  const Vector within = larger(smaller(x, high), low);
  Vector sum = within * curve.slope + curve.offset;
  for (std::size_t i = 0; i < curve.count; ++i) {
    sum = sum + magnitude(within - curve.knots[i]) * curve.bends[i];
  }
  copy(sum, value);
}

/// e^x of a negative x: a series of a fraction of it, squared again and again.
template <class Vector, typename Scalar>
SLIPWISE_LANES void negative_exponential(const Vector& x, Vector& power) {
  constexpr bool kFloat = std::is_same_v<Scalar, float>;
  constexpr int kSquares = kFloat ? 4 : 10;                         // of e^(x / 16) and of e^(x / 1024)
  constexpr auto kLeast = static_cast<Scalar>(kFloat ? -16 : -40);  // e^-16 of a gap is nothing in float
  constexpr int kTerms = 8;
  Vector least;
  fill(kLeast, least);
  const Vector part = larger(x, least) * (Scalar{1} / static_cast<Scalar>(kFloat ? 16 : 1024));
  Vector sum;
  fill(Scalar{1}, sum);
  for (int i = kTerms; i > 0; --i) {
    sum = sum * part * (Scalar{1} / static_cast<Scalar>(i)) + Scalar{1};
  }
  for (int i = 0; i < kSquares; ++i) {
    sum = sum * sum;
  }
  copy(sum, power);
}

/// What advance_car needs, in lanes.
template <class Vector, typename Scalar>
struct LaneCarFunctions {
  const LaneCarJob<Scalar>& job;

  SLIPWISE_LANES Vector curvature(const Vector& steering) const {
    Vector value;
    follow_curve(job.curvature, steering, value);
    return value;
  }
  SLIPWISE_LANES Vector size(const Vector& x) const { return magnitude(x); }
  SLIPWISE_LANES Vector left(const Vector& drag) const {
    Vector power{};
    if (job.lags) {
      negative_exponential<Vector, Scalar>(drag * job.minus_rate, power);
    }
    return power;
  }
};

/// Reads the commands of one period of a block.
template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES void read_car_commands(const LaneCarJob<Scalar>& job, const LaneCarBlock<Scalar>& block,
                                      const Scalar* commands, std::size_t period, typename L::Vector& command) {
  const Scalar* from = commands + static_cast<std::ptrdiff_t>(block.first) * job.rollout_stride +
                       static_cast<std::ptrdiff_t>(period) * job.period_stride;
  if (job.rollout_stride == 1 && block.count == L::kLanes) {
    load(from, command);
    return;
  }
  alignas(64) Scalar gathered[L::kLanes] = {};
  for (std::size_t i = 0; i < block.count; ++i) {
    gathered[i] = from[static_cast<std::ptrdiff_t>(i) * job.rollout_stride];
  }
  load(gathered, command);
}

/// Drives the cars of a block through all periods. A command that is not finite makes the twists so, too.
template <class Level, typename Scalar>
void drive_cars(const LaneCarJob<Scalar>& job, const LaneCarBlock<Scalar>& block) {
  using L = Lanes<Level, Scalar>;
  using Vector = L::Vector;
  const LaneCarFunctions<Vector, Scalar> functions{job};
  const auto half = static_cast<Scalar>(0.5);
  CarLanes<Vector> now;
  load(block.speed, now.speed);
  load(block.steering, now.steering);
  for (std::size_t period = 0; period < job.periods; ++period) {
    Vector throttle, steering, target, v, omega;
    read_car_commands<L>(job, block, job.throttle, period, throttle);
    read_car_commands<L>(job, block, job.steering, period, steering);
    follow_curve(job.speed, throttle, target);
    const Vector nothing = (throttle - throttle) + (steering - steering);
    copy(nothing, v);
    copy(nothing, omega);
    for (std::size_t i = 0; i < job.steps; ++i) {
      const CarLanes<Vector> next = advance_car(job.step, functions, now, target, steering);
      const Vector middle = (now.speed + next.speed) * half;
      const Vector curvature = functions.curvature((now.steering + next.steering) * half);
      v = v + middle * job.per_step;
      omega = omega + car_yaw_rate(middle, curvature, job.step.understeer) * job.per_step;
      copy(next.speed, now.speed);
      copy(next.steering, now.steering);
    }
    const std::size_t at = period * job.rollouts + block.first;
    store_first(v, block.count, job.v + at);
    store_first(omega, block.count, job.omega + at);
  }
}

}  // namespace slipwise
// NOLINTEND(modernize-avoid-c-arrays)
