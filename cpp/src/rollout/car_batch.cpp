// SPDX-License-Identifier: Apache-2.0
// The kernels drive the cars; steps are as those of a car's twists.
#include "slipwise/rollout/car_batch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "slipwise/actuator/first_order_lag.hpp"
#include "slipwise/rollout/check_batch.hpp"
#include "slipwise/rollout/kernel_of_level.hpp"
#include "slipwise/rollout/rollout_threads.hpp"

namespace slipwise {
namespace {

constexpr double kLongest = 0.02;     // [s] of a step; over it the yaw rate in the drag is held
constexpr double kStandstill = 0.05;  // [m/s] below which a yaw rate tells nothing of the steering
constexpr int kHalvings = 40;
constexpr double kLongestDelay = 60.0;  // [s]

std::size_t steps_of(double period) {
  return static_cast<std::size_t>(std::max(1.0, std::ceil(period / kLongest - 1e-9)));
}

/// The car after a period under a held command.
CarState driven(const CarCurves& car, CarState state, const BodyTwist& command, double period) {
  const std::size_t steps = steps_of(period);
  for (std::size_t i = 0; i < steps; ++i) {
    state = advanced(car, state, command, period / static_cast<double>(steps));
  }
  return state;
}

/// The numbers of a curve in lanes.
template <typename Scalar>
struct CurveNumbers {
  std::vector<Scalar> knots, bends;
  LaneCurve<Scalar> curve{};

  explicit CurveNumbers(const KnotCurve& from) {
    const std::size_t count = from.at.size();
    const auto slope = [&](std::size_t i) {
      return (from.value[i + 1] - from.value[i]) / (from.at[i + 1] - from.at[i]);
    };
    double offset = count > 0 ? from.value.front() : 0.0, along = 0.0;
    if (count > 1) {
      along = 0.5 * (slope(0) + slope(count - 2));
      offset -= along * from.at.front();
      for (std::size_t i = 1; i + 1 < count; ++i) {
        const double bend = 0.5 * (slope(i) - slope(i - 1));
        if (bend != 0.0) {
          knots.push_back(static_cast<Scalar>(from.at[i]));
          bends.push_back(static_cast<Scalar>(bend));
          offset -= bend * (from.at[i] - from.at.front());
        }
      }
    }
    curve = {.knots = knots.data(),
             .bends = bends.data(),
             .count = knots.size(),
             .first = static_cast<Scalar>(count > 0 ? from.at.front() : 0.0),
             .last = static_cast<Scalar>(count > 0 ? from.at.back() : 0.0),
             .offset = static_cast<Scalar>(offset),
             .slope = static_cast<Scalar>(along)};
  }
};

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

/// What cars do is the mean of what they would do without their delay so many periods before, and one more before that.
struct LatePeriods {
  std::size_t whole;
  double part;  ///< of the earlier one

  LatePeriods(double delay, double period)
      : whole(static_cast<std::size_t>(delay / period + 1e-9)),
        part(std::max(delay / period - static_cast<double>(whole), 0.0)) {}
  bool none() const { return whole == 0 && part == 0.0; }
  template <typename Scalar>
  Scalar mean(Scalar now, Scalar before) const {
    return static_cast<Scalar>(1.0 - part) * now + static_cast<Scalar>(part) * before;
  }
  /// Periods before the past that are asked for.
  std::size_t reach() const { return whole + 1; }
};

/// Where the car of a start begins, without its delay; adds its twists: as it drives for the reach of the delay, then
/// those of the past. What was sent in the time of the delay has not acted at the start.
template <typename Scalar>
CarState begin_of(const CarCurves& car, const RolloutBatch<Scalar>& batch, std::size_t start, double period,
                  std::vector<DriveCommand>& twists) {
  const DriveCommand& drive = batch.starts[start].drive;
  const std::size_t sent = batch.past.size() / batch.starts.size();
  twists.insert(twists.end(), LatePeriods(car.delay, period).reach(), drive);
  CarState state{.speed = drive.v, .steering = sent > 0 ? batch.past[start * sent].omega : steering_of(car, drive)};
  for (std::size_t k = 0; k < sent; ++k) {
    const DriveCommand& command = batch.past[start * sent + k];
    const BodyTwist held{.v = command.v, .vy = 0.0, .omega = command.omega};
    const double pending = std::clamp(car.delay / period - static_cast<double>(sent - k - 1), 0.0, 1.0);  // of a period
    if (pending < 1.0) {
      state = {.speed = drive.v, .steering = driven(car, state, held, (1.0 - pending) * period).steering};
    }
    double speed = state.speed;
    if (pending > 0.0) {
      state = driven(car, state, held, pending * period);
      speed += 0.5 * pending * (state.speed - speed);
    }
    const BodyTwist twist = car_twist(car, {.speed = speed, .steering = state.steering});
    twists.push_back({.v = twist.v, .omega = twist.omega});
  }
  return state;
}

/// Makes twists without a delay those with it; `before` are the earlier ones of each start, of which the past's follow.
template <typename Scalar>
void delay_twists(const LatePeriods& late, std::size_t rollouts, const std::vector<DriveCommand>& before,
                  std::size_t starts, CarBatch<Scalar>& batch) {
  const std::size_t known = before.size() / starts, periods = batch.v.size() / std::max<std::size_t>(rollouts, 1);
  for (std::size_t k = late.none() ? known : periods + known; k-- > known;) {
    for (std::size_t r = 0; r < rollouts; ++r) {
      const DriveCommand* own = before.data() + (starts == 1 ? 0 : r) * known;
      const auto delay = [&](std::vector<Scalar>& values, double DriveCommand::* number) {
        const auto at = [&](std::size_t i) {
          return i < known ? static_cast<Scalar>(own[i].*number) : values[(i - known) * rollouts + r];
        };
        values[(k - known) * rollouts + r] = late.mean(at(k - late.whole), at(k - late.whole - 1));
      };
      delay(batch.v, &DriveCommand::v);
      delay(batch.omega, &DriveCommand::omega);
    }
  }
  for (std::size_t start = 0; start < starts; ++start) {
    for (std::size_t i = start * known + 1; i + late.whole < (start + 1) * known; ++i) {
      batch.past.push_back(
          {.v = late.mean(before[i].v, before[i - 1].v), .omega = late.mean(before[i].omega, before[i - 1].omega)});
    }
  }
}

template <typename Scalar>
LaneCarJob<Scalar> job_of(const CarCurves& car, const RolloutBatch<Scalar>& batch, double period) {
  const auto number = [](double value) { return static_cast<Scalar>(value); };
  const std::size_t steps = steps_of(period);
  const double step = period / static_cast<double>(steps);
  return {.speed = {},
          .curvature = {},
          .step = {.cornering_drag = number(car.cornering_drag),
                   .understeer = number(car.understeer),
                   .steering_left = number(lag_output(1.0, 0.0, car.steering_lag, step))},
          .minus_rate = number(car.lag > 0.0 ? -step / car.lag : 0.0),
          .lags = car.lag > 0.0,
          .steps = steps,
          .per_step = number(1.0 / static_cast<double>(steps)),
          .rollouts = batch.rollouts,
          .periods = batch.periods,
          .throttle = batch.commands.v,
          .steering = batch.commands.omega,
          .rollout_stride = batch.commands.rollout_stride,
          .period_stride = batch.commands.period_stride,
          .v = nullptr,
          .omega = nullptr};
}

}  // namespace

template <typename Scalar>
CarBatch<Scalar> car_batch(const CarCurves& car, const RolloutBatch<Scalar>& batch, double period,
                           const RolloutOptions& options) {
  check_batch(batch);
  if (!(period > 0.0) || batch.commands.vy != nullptr) {
    throw std::invalid_argument("a car's rollouts need throttle and steering, and a positive period");
  }
  if (!(car.delay >= 0.0) || car.delay > kLongestDelay) {
    throw std::invalid_argument("a car's delay must be between 0 and " + std::to_string(kLongestDelay) + " s, got " +
                                std::to_string(car.delay));
  }
  const std::size_t starts = batch.starts.size(), size = batch.rollouts * batch.periods;
  CarBatch<Scalar> result{std::vector<Scalar>(size), std::vector<Scalar>(size), {}};
  std::vector<CarState> begin;
  std::vector<DriveCommand> before;
  for (std::size_t i = 0; i < starts; ++i) {
    begin.push_back(begin_of(car, batch, i, period, before));
  }
  const CurveNumbers<Scalar> speed(car.speed), curvature(car.curvature);
  LaneCarJob<Scalar> job = job_of(car, batch, period);
  job.speed = speed.curve;
  job.curvature = curvature.curve;
  job.v = result.v.data();
  job.omega = result.omega.data();
  const LaneKernelOfLevel<Scalar> kernel = kernel_of<Scalar>(options.level);
  share_out((batch.rollouts + kernel.lanes - 1) / kernel.lanes, options.threads, [&](std::size_t at, std::size_t end) {
    alignas(64) std::array<Scalar, kMostLanes> speeds{}, steerings{};
    for (; at < end; ++at) {
      const std::size_t first = at * kernel.lanes, count = std::min(kernel.lanes, batch.rollouts - first);
      for (std::size_t i = 0; i < count; ++i) {
        const CarState& state = begin[starts == 1 ? 0 : first + i];
        speeds[i] = static_cast<Scalar>(state.speed);
        steerings[i] = static_cast<Scalar>(state.steering);
      }
      kernel.drive_cars(job, {.speed = speeds.data(), .steering = steerings.data(), .first = first, .count = count});
    }
  });
  delay_twists(LatePeriods(car.delay, period), batch.rollouts, before, starts, result);
  return result;
}

template CarBatch<float> car_batch(const CarCurves&, const RolloutBatch<float>&, double, const RolloutOptions&);
template CarBatch<double> car_batch(const CarCurves&, const RolloutBatch<double>&, double, const RolloutOptions&);

}  // namespace slipwise
