// SPDX-License-Identifier: Apache-2.0
// Speeds of an axis over all records, sorted.
#include "slipwise/identify/axis_range.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kRounding =
    1e-9;  // [m/s or rad/s]; what is slower, or differs by less, is what rounding leaves of zero
constexpr double kRateStride = 0.2;  // [s] over which measured accelerations are taken

/// A twist in an axis: once, or once for each side.
std::array<double, 2> in_axis(const CommandLimits& limits, LimitedAxis axis, const BodyTwist& twist) {
  if (axis == LimitedAxis::Side) {
    const SideSpeeds sides = side_speeds(limits, twist);
    return {sides.left, sides.right};
  }
  const double one = axis == LimitedAxis::Speed ? twist.v : twist.omega;
  return {one, one};
}

/// Wheels have passed all gains.
CommandLimits of_wheels(const CommandLimits& limits) { return {.wheel_separation = limits.wheel_separation}; }

void add_commands(AxisRange& range, const CommandLimits& limits, LimitedAxis axis, const InputHistory& commands) {
  std::array<double, 2> before{};
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const BodyTwist twist = commands.sample(i);
    const std::array<double, 2> now = in_axis(limits, axis, twist);
    for (std::size_t side = 0; side < now.size(); ++side) {
      range.step = std::max(range.step, std::abs(now.at(side) - before.at(side)));
      if (std::abs(now.at(side)) > kRounding) {
        range.commands.push_back({std::abs(now.at(side)), {twist.v, side == 0 ? -twist.omega : twist.omega}});
      }
    }
    before = now;
  }
}

void add_wheels(AxisRange& range, const CommandLimits& limits, LimitedAxis axis, const WheelRecord& record) {
  std::size_t from = 0;
  for (std::size_t i = 0; i < record.t.size(); ++i) {
    const double seconds = record.t[i] - record.t[from];
    const bool apart = !later(kRateStride, seconds);
    const std::array<double, 2> now = in_axis(limits, axis, record.wheels[i]);
    const std::array<double, 2> before = in_axis(limits, axis, record.wheels[from]);
    for (std::size_t side = 0; side < now.size(); ++side) {
      range.speeds.push_back(std::abs(now.at(side)));
      if (apart) {
        range.rates.push_back(std::abs(now.at(side) - before.at(side)) / seconds);
      }
    }
    from = apart ? i : from;
  }
}

}  // namespace

AxisRange axis_range(std::span<const WheelRecord> records, const CommandLimits& limits, LimitedAxis axis) {
  AxisRange range;
  for (const WheelRecord& record : records) {
    const bool behind = axis == LimitedAxis::Side && !unlimited(channel_limits(limits));
    add_commands(range, limits, axis,
                 behind ? limited_inputs(record.commands, channel_limits(limits)) : record.commands);
    add_wheels(range, of_wheels(limits), axis, record);
  }
  std::ranges::sort(range.commands, {}, &Asked::speed);
  std::ranges::sort(range.speeds);
  std::ranges::sort(range.rates);
  const auto repeated = std::ranges::unique(
      range.commands, [](double one, double next) { return next - one <= kRounding; }, &Asked::speed);
  range.commands.erase(repeated.begin(), repeated.end());
  return range;
}

}  // namespace slipwise
