// SPDX-License-Identifier: Apache-2.0
// Cutting the control period where delayed commands begin to act.
#include "slipwise/rollout/actuator_schedule.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "slipwise/actuator/first_order_lag.hpp"

namespace slipwise {
namespace {

constexpr double kMostPeriods = 1e6;  // that a command may take to act
constexpr double kSamePart = 1e-9;    // of a period: delays that differ by less act together

template <typename T>
ChannelTimingOf<T> time_channel(const AxisResponseOf<T>& response, const T& delay, double period) {
  double whole = std::floor(value_of(delay) / period);
  if (!(std::abs(whole) <= kMostPeriods)) {
    throw std::invalid_argument("a command that acts after " + std::to_string(value_of(delay)) + " s is more than " +
                                std::to_string(kMostPeriods) + " periods of " + std::to_string(period) +
                                " s late; use longer periods");
  }
  T rest = delay - whole * period;
  if (value_of(rest) > (1.0 - kSamePart) * period) {
    whole += 1.0;
    rest = T(0.0);
  }
  return {static_cast<std::ptrdiff_t>(whole), value_of(rest) < kSamePart * period ? T(0.0) : rest, response};
}

template <typename T>
LagFractionOf<T> fraction_of(const T& time_constant, const T& duration) {
  using std::expm1;
  if (!(value_of(time_constant) > 0.0)) {
    return {T(0.0), T(0.0)};
  }
  const T gone = -expm1(-duration / time_constant);
  return {time_constant * gone / duration, 1.0 - gone};
}

template <typename T>
ChannelFractionOf<T> fraction_of(const AxisResponseOf<T>& response, const T& duration) {
  return {fraction_of(response.time_constant, duration), fraction_of(response.slow_time_constant, duration)};
}

template <typename T>
bool lags(const ChannelTimingOf<T>& channel) {
  return channel.response.longest_lag() > 0.0;
}
template <typename T>
bool responds(const ChannelTimingOf<T>& channel) {
  return channel.response.has_slow_mode() || value_of(channel.response.gain) != 1.0;
}

/// A stretch of constant delayed commands, cut so that no part with lag is longer than the actuator's own steps are.
template <typename T>
std::vector<PeriodPartOf<T>> cut(const ActuatorScheduleOf<T>& actuator, const T& duration, bool next_v,
                                 bool next_omega) {
  if (!(value_of(duration) > 0.0)) {
    return {};
  }
  const int count = actuator.lags ? lag_parts(value_of(duration), ActuatorSpan{}.longest_step) : 1;
  const T part = duration / static_cast<double>(count);
  std::vector<PeriodPartOf<T>> parts(
      static_cast<std::size_t>(count),
      {part, false, false, fraction_of(actuator.v.response, part), fraction_of(actuator.omega.response, part)});
  parts.front().next_v = next_v;
  parts.front().next_omega = next_omega;
  return parts;
}

}  // namespace

ActuatorNumbers<ActuatorDual> differentiable_numbers(const MotionModel& model,
                                                     const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  const ActuatorModel actuator = model.actuator(parameters);
  const Eigen::VectorXd rates = model.actuator_scales(actuator);
  const std::vector<Eigen::Index>& places = model.actuator_places();
  const auto number = [&](double value, Eigen::Index place) {
    const auto found = std::ranges::find(places, place) - places.begin();
    return found == std::ssize(places) ? ActuatorDual(value)
                                       : ActuatorDual::variable(value, static_cast<int>(found), rates[found]);
  };
  const ActuatorDual clock_offset = number(actuator.clock_offset, 4);
  return {.v = {number(actuator.gain_v, 5), number(actuator.time_constant_v, 0), number(actuator.slow_fraction_v, 7),
                number(actuator.slow_time_constant_v, 9)},
          .omega = {number(actuator.gain_omega, 6), number(actuator.time_constant_omega, 1),
                    number(actuator.slow_fraction_omega, 8), number(actuator.slow_time_constant_omega, 10)},
          .delay_v = number(actuator.delay_v, 2) + clock_offset,
          .delay_omega = number(actuator.delay_omega, 3) + clock_offset,
          .wheelbase = actuator.wheelbase};
}

template <typename T>
ActuatorScheduleOf<T> schedule_actuator(const ActuatorNumbers<T>& actuator, double period) {
  if (!(period > 0.0) || !std::isfinite(period)) {
    throw std::invalid_argument("the time between two commands must be a positive number of seconds, got " +
                                std::to_string(period));
  }
  const ChannelTimingOf<T> v = time_channel(actuator.v, actuator.delay_v, period);
  const ChannelTimingOf<T> omega = time_channel(actuator.omega, actuator.delay_omega, period);
  const bool v_first = value_of(v.rest) < value_of(omega.rest);
  const T first = v_first ? v.rest : omega.rest;
  const T second = v_first ? omega.rest : v.rest;
  const bool together = value_of(first) == value_of(second);
  const bool v_last = together || !v_first, omega_last = together || v_first;
  ActuatorScheduleOf<T> schedule{period, v, omega, lags(v) || lags(omega), responds(v) || responds(omega), {},
                                 {},     0, {},    actuator.wheelbase};
  schedule.lead_in = cut(schedule, first, false, false);
  if (!together) {
    schedule.cycle = cut(schedule, T(second - first), v_first, !v_first);
  }
  schedule.branch = schedule.cycle.size();
  const auto last = cut(schedule, T(first + period - second), v_last, omega_last);
  schedule.cycle.insert(schedule.cycle.end(), last.begin(), last.end());
  if (value_of(first) > 0.0) {
    schedule.tail = cut(schedule, T(period - second), v_last, omega_last);
  } else {
    schedule.branch = schedule.cycle.size();
  }
  return schedule;
}

template ActuatorScheduleOf<double> schedule_actuator(const ActuatorNumbers<double>&, double);
template ActuatorScheduleOf<ActuatorDual> schedule_actuator(const ActuatorNumbers<ActuatorDual>&, double);

ActuatorSchedule schedule_actuator(const ActuatorModel& actuator, double period) {
  return schedule_actuator(ActuatorNumbers<double>{.v = speed_response(actuator),
                                                   .omega = yaw_rate_response(actuator),
                                                   .delay_v = actuator.delay_v + actuator.clock_offset,
                                                   .delay_omega = actuator.delay_omega + actuator.clock_offset,
                                                   .wheelbase = actuator.wheelbase},
                           period);
}

}  // namespace slipwise
