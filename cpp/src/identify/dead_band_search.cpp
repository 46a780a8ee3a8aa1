// SPDX-License-Identifier: Apache-2.0
// Placing dead-bands between commands, coarsely and then finely.
#include "slipwise/identify/dead_band_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vector>

#include "slipwise/identify/axis_range.hpp"

namespace slipwise {
namespace {

constexpr double kPlateau = 4.0;       // of -2 log likelihood: a dead-band within two standard deviations
constexpr double kNear = 0.1;          // of a dead-band; which commands it blocks may turn on what they ask for
constexpr std::ptrdiff_t kBeside = 3;  // places tried on each side

/// The drive with a dead-band that blocks command `at` and none faster.
LimitedActuator with_dead_band(LimitedActuator drive, LimitedAxis axis, const std::vector<Asked>& commands,
                               std::ptrdiff_t at) {
  const auto place = static_cast<std::size_t>(at);
  axis_of(drive.limits, axis).dead_band = 0.5 * (commands[place].speed + commands[place + 1].speed);
  return drive;
}

/// The first command that the dead-band lets through.
std::ptrdiff_t first_passed(const std::vector<Asked>& commands, double dead_band) {
  return std::ranges::lower_bound(commands, dead_band, {}, &Asked::speed) - commands.begin();
}

/// How many steps one may go on, each further one too, with few questions: strides grow, and begin again.
template <typename MayGo>
std::ptrdiff_t steps_as_long_as(MayGo may_go) {
  std::ptrdiff_t steps = 0;
  for (std::ptrdiff_t stride = 1; may_go(steps + stride) || stride > 1;) {
    const bool went = may_go(steps + stride);
    steps += went ? stride : 0;
    stride = went ? 2 * stride : 1;
  }
  return steps;
}

}  // namespace

ScoredActuator DeadBandSearch::best(ScoredActuator drive) const {
  for (const LimitedAxis axis : kLimitedAxes) {
    if (axis_of(drive.drive.limits, axis).dead_band > 0.0) {
      drive = best(drive, axis);
    }
  }
  return drive;
}

LimitedActuator DeadBandSearch::between_commands(LimitedActuator drive) const {
  drive.edge.reset();
  if (drive.limits.side.dead_band > 0.0) {
    const std::vector<Asked> commands = axis_range(records_, drive.limits, LimitedAxis::Side).commands;
    const std::ptrdiff_t passed = first_passed(commands, drive.limits.side.dead_band);
    if (passed > 0 && passed < std::ssize(commands)) {
      const auto place = static_cast<std::size_t>(passed);
      drive.edge = {commands[place - 1].of_side, commands[place].of_side};
    }
  }
  return drive;
}

ScoredActuator DeadBandSearch::best(const ScoredActuator& drive, LimitedAxis axis) const {
  const std::vector<Asked> commands = axis_range(records_, drive.drive.limits, axis).commands;
  if (commands.size() < 2) {
    return drive;
  }
  ScoredActuator best = drive;
  const std::ptrdiff_t last = std::ssize(commands) - 2;
  std::ptrdiff_t centre = first_passed(commands, axis_of(drive.drive.limits, axis).dead_band) - 1;
  for (std::ptrdiff_t stride = std::max<std::ptrdiff_t>(last / 8, 1);;
       stride = std::max<std::ptrdiff_t>(stride / kBeside, 1)) {
    std::ptrdiff_t found = centre;
    for (std::ptrdiff_t k = -kBeside; k <= kBeside; ++k) {
      const std::ptrdiff_t at = std::clamp<std::ptrdiff_t>(centre + k * stride, 0, last);
      const ScoredActuator trial = fit_.scored(with_dead_band(drive.drive, axis, commands, at));
      if (trial.loss.total < best.loss.total) {
        best = trial;
        found = at;
      }
    }
    centre = found;
    if (stride == 1) {
      return best;
    }
  }
}

double DeadBandSearch::std(const ScoredActuator& drive, LimitedAxis axis, const Eigen::Matrix3d& to_sides) const {
  const CommandLimits& limits = drive.drive.limits;
  const std::vector<Asked> commands = axis_range(records_, limits, axis).commands;
  const double value = axis_of(limits, axis).dead_band;
  const std::ptrdiff_t passed = first_passed(commands, value);
  const auto alike = [&](std::ptrdiff_t at) {
    return at >= 0 && at + 1 < std::ssize(commands) &&
           fit_.scored(with_dead_band(drive.drive, axis, commands, at)).loss.total - drive.loss.total <
               kPlateau * drive.loss.inflation;
  };
  const std::ptrdiff_t low = passed - 1 - steps_as_long_as([&](std::ptrdiff_t n) { return alike(passed - 1 - n); });
  const std::ptrdiff_t high = passed + steps_as_long_as([&](std::ptrdiff_t n) { return alike(passed - 1 + n); });
  const double lower = low >= 0 ? commands[static_cast<std::size_t>(low)].speed : 0.0;
  const double upper = high < std::ssize(commands) ? commands[static_cast<std::size_t>(high)].speed : value;
  const double plateau = std::max(upper - value, value - lower) / std::numbers::sqrt3;
  return std::hypot(plateau, axis == LimitedAxis::Side ? side_std(limits, lower, upper, to_sides) : 0.0);
}

/// How uncertain it is what the commands ask of a side that ask for about `lower` to `upper`.
double DeadBandSearch::side_std(const CommandLimits& limits, double lower, double upper,
                                const Eigen::Matrix3d& to_sides) const {
  double variance = 0.0;
  for (const Asked& command : axis_range(records_, limits, LimitedAxis::Side).commands) {
    if (command.speed > (1.0 - kNear) * lower && command.speed < (1.0 + kNear) * upper) {
      const double half = 0.5 * command.of_side.omega * limits.wheel_separation;
      const Eigen::Vector3d derivative(command.of_side.v, half, half * limits.gain_omega);
      variance = std::max(variance, derivative.dot(to_sides * derivative));
    }
  }
  return std::sqrt(variance);
}

}  // namespace slipwise
