// SPDX-License-Identifier: Apache-2.0
// Between a limited drive and its parameters in a row.
#include "slipwise/identify/limited_actuator_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace slipwise {
namespace {

constexpr double kLeastGain = 0.05;  // a drive does not turn its commands round

/// Where an axis's limit of a kind stands; dead-bands are no smooth parameters.
int place_of(std::size_t axis, std::size_t kind) {
  return kFirstLimit + static_cast<int>(axis) * kLimitsPerAxis + static_cast<int>(kind) - 1;
}

}  // namespace

LimitParameters parameters_of(const LimitedActuator& drive) {
  const ActuatorModel& actuator = drive.actuator;
  const CommandLimits& limits = drive.limits;
  LimitParameters p;
  p.head<kFirstLimit>() << limits.gain_v, limits.gain_omega, std::log(actuator.time_constant_v),
      std::log(actuator.time_constant_omega), std::log(actuator.delay_v), std::log(actuator.delay_omega),
      std::log(limits.wheel_separation);
  for (std::size_t axis = 0; axis < kLimitedAxes.size(); ++axis) {
    for (std::size_t kind = 1; kind < kLimitKinds.size(); ++kind) {
      p[place_of(axis, kind)] = std::log(limit_of(axis_of(limits, kLimitedAxes.at(axis)), kLimitKinds.at(kind)));
    }
  }
  return p;
}

LimitedActuator with_parameters(LimitedActuator drive, const LimitParameters& p) {
  ActuatorModel& actuator = drive.actuator;
  drive.limits.gain_v = std::max(p[0], kLeastGain);
  drive.limits.gain_omega = std::max(p[1], kLeastGain);
  actuator.time_constant_v = std::exp(p[2]);
  actuator.time_constant_omega = std::exp(p[3]);
  actuator.delay_v = std::exp(p[4]);
  actuator.delay_omega = std::exp(p[5]);
  drive.limits.wheel_separation = std::exp(p[kSeparationPlace]);
  for (std::size_t axis = 0; axis < kLimitedAxes.size(); ++axis) {
    for (std::size_t kind = 1; kind < kLimitKinds.size(); ++kind) {
      limit_of(axis_of(drive.limits, kLimitedAxes.at(axis)), kLimitKinds.at(kind)) = std::exp(p[place_of(axis, kind)]);
    }
  }
  if (drive.edge && drive.limits.side.dead_band > 0.0) {
    const auto& [blocked, passed] = *drive.edge;
    drive.limits.side.dead_band = 0.5 * (speed_of_side(drive.limits, blocked) + speed_of_side(drive.limits, passed));
  }
  return drive;
}

std::vector<int> free_parameters(const LimitedActuator& drive) {
  std::vector<int> free(kActuatorPart);
  std::iota(free.begin(), free.end(), 0);
  if (limits_sides(drive.limits)) {
    free.push_back(kSeparationPlace);
  }
  for (std::size_t axis = 0; axis < kLimitedAxes.size(); ++axis) {
    for (std::size_t kind = 1; kind < kLimitKinds.size(); ++kind) {
      if (limits_anything(axis_of(drive.limits, kLimitedAxes.at(axis)), kLimitKinds.at(kind))) {
        free.push_back(place_of(axis, kind));
      }
    }
  }
  return free;
}

bool is_lag(int parameter) { return parameter == kFirstLag || parameter == kFirstLag + 1; }

bool acts_behind(int parameter, const LimitedActuator& drive) {
  const bool gain = parameter < 2;  // in front of the sides, where these are limited
  return parameter < kActuatorPart && !(gain && limits_sides(drive.limits)) &&
         !(is_lag(parameter) && drive.rates_behind_lag && limits_rates(drive.limits));
}

bool acts_on(int parameter, const LimitedActuator& drive, int channel) {
  const bool sides = limits_sides(drive.limits);
  if (acts_behind(parameter, drive) || (parameter < kActuatorPart && !sides)) {
    return parameter % 2 == channel;
  }
  return sides || (parameter - kFirstLimit) / kLimitsPerAxis == channel;
}

PriorPull prior_pull(int parameter, const LimitParameters& p, const PriorSettings& prior, double wheel_separation) {
  const auto pull = [](double std, double gap) { return PriorPull{1.0 / (std * std), gap}; };
  if (parameter < 2) {
    return pull(prior.gain_std, p[parameter] - 1.0);
  }
  if (parameter < 4) {
    return pull(prior.log_std, p[parameter] - std::log(prior.time_constant));
  }
  if (parameter < kActuatorPart) {
    return pull(prior.log_std, p[parameter] - std::log(prior.delay));
  }
  return parameter == kSeparationPlace ? pull(kSeparationLogStd, p[kSeparationPlace] - std::log(wheel_separation))
                                       : PriorPull{0.0, 0.0};
}

}  // namespace slipwise
