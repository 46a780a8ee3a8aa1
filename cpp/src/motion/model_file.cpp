// SPDX-License-Identifier: Apache-2.0
// Puts the numbers of a model file where the motion model and the limits have them.
#include "slipwise/motion/model_file.hpp"

#include <cstddef>
#include <stdexcept>

#include "slipwise/actuator/limit_kinds.hpp"

namespace slipwise {
namespace {

constexpr std::size_t kGains = 2;

double& kind_of(AxisLimits& axis, const std::string& kind, const std::string& name) {
  for (const LimitRow& row : kLimits) {
    if (kind == row.name) {
      return axis.*row.value;
    }
  }
  throw std::invalid_argument("no drive has a limit " + name);
}

double& limit_of(CommandLimits& limits, const std::string& name) {
  if (name == "limits.wheel_separation") {
    return limits.wheel_separation;
  }
  const std::size_t axis = name.find('.') + 1;
  const std::size_t kind = name.rfind('.');
  const std::string of = name.substr(axis, kind - axis);
  if (of != "speed" && of != "yaw_rate" && of != "side") {
    throw std::invalid_argument("no drive has a limit " + name);
  }
  AxisLimits& limited = of == "speed" ? limits.speed : of == "yaw_rate" ? limits.yaw_rate : limits.side;
  return kind_of(limited, name.substr(kind + 1), name);
}

}  // namespace

RolloutModel ModelFile::model() const {
  const std::size_t size = rows.size();
  if (covariance.size() != size * size) {
    throw std::invalid_argument(std::to_string(size) + " parameters with a covariance of " +
                                std::to_string(covariance.size()) + " numbers; is the file or message whole?");
  }
  if (!limit_gains.empty() && limit_gains.size() != kGains) {
    throw std::invalid_argument("limit_gains are of speed and yaw rate: two numbers");
  }
  RolloutModel found;
  if (!limit_gains.empty()) {
    found.limits.gain_v = limit_gains.front();
    found.limits.gain_omega = limit_gains.back();
  }
  std::vector<std::size_t> kept;  // what is of the robot, not of its sensors
  for (std::size_t i = 0; i < size; ++i) {
    const Row& row = rows[i];
    if (row.stage == "slip" || row.stage == "force" || row.stage == "actuator") {
      kept.push_back(i);
    } else if (row.stage == "limits") {
      limit_of(found.limits, row.name) = row.value;
    } else if (row.stage != "clock" && row.stage != "sensor" && row.stage != "mount") {
      throw std::invalid_argument("the model has a stage '" + row.stage + "', which rollouts do not know");
    }
  }
  check(found.limits);
  ActuatorParameters of_body = learned;
  of_body.dynamics = learned.dynamics || learned.response;
  of_body.clock_offset = of_body.sensor_extrinsics = false;
  found.motion = MotionModel(Basis(basis, lon, lat, ang), of_body);
  if (found.motion.basis().by_heading()) {
    throw std::invalid_argument("a force of the model depends on the heading over the map, which rollouts do not know");
  }
  const auto count = static_cast<Eigen::Index>(kept.size());
  found.parameters.resize(count);
  found.covariance.resize(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t at = kept[static_cast<std::size_t>(i)];
    found.parameters[i] = rows[at].value;
    for (Eigen::Index j = 0; j < count; ++j) {
      found.covariance(i, j) = covariance[at * size + kept[static_cast<std::size_t>(j)]];
    }
  }
  found.motion.check(found.parameters);
  return found;
}

}  // namespace slipwise
