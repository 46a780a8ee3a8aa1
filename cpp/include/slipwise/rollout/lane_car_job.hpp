// SPDX-License-Identifier: Apache-2.0
// What the kernel of a car is handed: plain pointers and numbers, as in lane_job.hpp.
#pragma once

#include <cstddef>

#include "slipwise/actuator/car_step.hpp"

namespace slipwise {

/// A curve that is straight between its knots and level beyond the first and the last:
/// offset + slope x + sum bends |x - knots|, with x kept between these.
template <typename Scalar>
struct LaneCurve {
  const Scalar* knots;
  const Scalar* bends;
  std::size_t count;  ///< of the knots at which it bends
  Scalar first, last, offset, slope;
};

template <typename Scalar>
struct LaneCarJob {
  LaneCurve<Scalar> speed, curvature;
  CarStep<Scalar> step;
  Scalar minus_rate;  ///< -duration of a step / lag of the speed
  bool lags;          ///< the speed
  std::size_t steps;  ///< of a period
  Scalar per_step;    ///< one over these

  std::size_t rollouts, periods;
  const Scalar* throttle;
  const Scalar* steering;
  std::ptrdiff_t rollout_stride, period_stride;
  Scalar* v;      ///< [periods * rollouts] mean twists
  Scalar* omega;  ///< [periods * rollouts]
};

/// Some neighbouring rollouts and what their cars do at the start, one a lane.
template <typename Scalar>
struct LaneCarBlock {
  const Scalar* speed;
  const Scalar* steering;
  std::size_t first;
  std::size_t count;
};

/// Drives the cars of a block; one function per instruction level.
template <typename Scalar>
using LaneCar = void (*)(const LaneCarJob<Scalar>& job, const LaneCarBlock<Scalar>& block);

}  // namespace slipwise
