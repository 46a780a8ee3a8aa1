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

ChannelTiming time_channel(const AxisResponse& response, double delay, double period) {
  double whole = std::floor(delay / period);
  if (!(std::abs(whole) <= kMostPeriods)) {
    throw std::invalid_argument("a command that acts after " + std::to_string(delay) + " s is more than " +
                                std::to_string(kMostPeriods) + " periods of " + std::to_string(period) +
                                " s late; use longer periods");
  }
  double rest = delay - whole * period;
  if (rest > (1.0 - kSamePart) * period) {
    whole += 1.0;
    rest = 0.0;
  }
  return {static_cast<std::ptrdiff_t>(whole), rest < kSamePart * period ? 0.0 : rest, response};
}

LagFraction fraction_of(double time_constant, double duration) {
  const LagDecay decay(time_constant, duration);
  return {time_constant > 0.0 ? time_constant * decay.gone / duration : 0.0, decay.left};
}

ChannelFraction fraction_of(const AxisResponse& response, double duration) {
  return {fraction_of(response.time_constant, duration), fraction_of(response.slow_time_constant, duration)};
}

bool lags(const ChannelTiming& channel) { return channel.response.longest_lag() > 0.0; }
bool responds(const ChannelTiming& channel) { return channel.response.has_slow_mode() || channel.response.gain != 1.0; }

/// A stretch of constant delayed commands, cut so that no part with lag is longer than the actuator's own steps are.
std::vector<PeriodPart> cut(const ActuatorSchedule& actuator, double duration, bool next_v, bool next_omega) {
  if (!(duration > 0.0)) {
    return {};
  }
  const int count = actuator.lags ? lag_parts(duration, ActuatorSpan{}.longest_step) : 1;
  const double part = duration / count;
  std::vector<PeriodPart> parts(
      static_cast<std::size_t>(count),
      {part, false, false, fraction_of(actuator.v.response, part), fraction_of(actuator.omega.response, part)});
  parts.front().next_v = next_v;
  parts.front().next_omega = next_omega;
  return parts;
}

}  // namespace

ActuatorSchedule schedule_actuator(const ActuatorModel& actuator, double period) {
  if (!(period > 0.0) || !std::isfinite(period)) {
    throw std::invalid_argument("the time between two commands must be a positive number of seconds, got " +
                                std::to_string(period));
  }
  const ChannelTiming v = time_channel(speed_response(actuator), actuator.delay_v + actuator.clock_offset, period);
  const ChannelTiming omega =
      time_channel(yaw_rate_response(actuator), actuator.delay_omega + actuator.clock_offset, period);
  const double first = std::min(v.rest, omega.rest);
  const double second = std::max(v.rest, omega.rest);
  const bool together = first == second;
  ActuatorSchedule schedule{period, v, omega, lags(v) || lags(omega), responds(v) || responds(omega), {},
                            {},     0, {},    actuator.wheelbase};
  schedule.lead_in = cut(schedule, first, false, false);
  if (!together) {
    schedule.cycle = cut(schedule, second - first, v.rest == first, omega.rest == first);
  }
  schedule.branch = schedule.cycle.size();
  const std::vector<PeriodPart> last = cut(schedule, first + period - second, v.rest == second, omega.rest == second);
  schedule.cycle.insert(schedule.cycle.end(), last.begin(), last.end());
  if (first > 0.0) {
    schedule.tail = cut(schedule, period - second, v.rest == second, omega.rest == second);
  } else {
    schedule.branch = schedule.cycle.size();
  }
  return schedule;
}

}  // namespace slipwise
