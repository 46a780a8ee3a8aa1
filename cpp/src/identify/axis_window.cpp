// SPDX-License-Identifier: Apache-2.0
// An axis by the logarithms of its times, with the deviation beside its actuator.
#include "slipwise/identify/axis_window.hpp"

#include <algorithm>
#include <cmath>

#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kSlowRange, 0.3);  // of the speed range, that the slow mode may hold

/// The fastest that the axis was commanded to go, or went.
double fastest(const ChannelWindow& window, const ActuatorAxis& axis) {
  const auto& [inputs, observed] = window;
  double speed = 0.0;
  for (const BodyTwist& twist : observed.twist) {
    speed = std::max(speed, std::abs(twist.*axis.part));
  }
  const std::size_t until = inputs.count_until(observed.edges.back());
  const std::size_t from = inputs.count_until(observed.edges.front() - axis.delay);
  for (std::size_t k = std::max<std::size_t>(from, 1) - 1; k < until; ++k) {
    speed = std::max(speed, std::abs(inputs.sample(k).*axis.part));
  }
  return speed;
}

}  // namespace

ActuatorAxis axis_of(double BodyTwist::* part, const ChannelParameters& parameters) {
  return {part,
          {.gain = parameters[2],
           .time_constant = std::exp(parameters[0]),
           .slow_fraction = parameters[3],
           .slow_time_constant = std::exp(parameters[4])},
          std::exp(parameters[1])};
}

std::optional<FirstAxisState> first_state(const ChannelWindow& window, const ActuatorAxis& axis, double deviation) {
  const double range = fastest(window, axis);
  if (!(range > 0.0)) {
    return std::nullopt;
  }
  const AxisState settled = settled_axis(window.inputs, axis, window.observed.edges.front());
  return FirstAxisState{{settled.fast, settled.slow, 0.0}, {range * range, std::pow(kSlowRange * range, 2), deviation}};
}

AxisMotion axis_through(const ChannelWindow& window, const ActuatorAxis& axis, const AxisState& start) {
  AxisMotion motion = axis_motion(window.inputs, axis, start, window.observed.edges);
  motion.derivative.col(0) *= axis.response.time_constant;
  motion.derivative.col(1) *= axis.delay;
  motion.derivative.col(4) *= axis.response.slow_time_constant;
  return motion;
}

AxisWindow axis_window(const ChannelWindow& window, const ActuatorAxis& axis, const AxisVector& start,
                       const ActuatorNoiseMeans& noise) {
  const AxisMotion motion = axis_through(window, axis, {.fast = start[0], .slow = start[1]});
  const Eigen::Index rows = motion.value.size() + 1;
  const Eigen::Index k = rows - kAxisStates;
  AxisWindow model{Eigen::VectorXd(rows), Eigen::Matrix<double, Eigen::Dynamic, kChannelParameters>(rows, 5),
                   Eigen::Matrix<double, Eigen::Dynamic, kAxisStates>::Zero(rows, 3)};
  model.value << motion.value, noise.by_start[k] * start[2];
  model.value.head(k) += noise.by_start.head(k) * start[2];
  model.by_actuator << motion.derivative.leftCols<kChannelParameters>(), Eigen::RowVectorXd::Zero(kChannelParameters);
  model.by_state.topLeftCorner(rows - 1, 2) = motion.derivative.rightCols<2>();
  model.by_state.col(2).head(k) = noise.by_start.head(k);
  model.by_state(rows - 1, 2) = noise.by_start[k];
  return model;
}

Eigen::VectorXd axis_means(const WheelMeans& observed, const ActuatorAxis& axis) {
  Eigen::VectorXd means(std::ssize(observed.twist));
  for (Eigen::Index k = 0; k < means.size(); ++k) {
    means[k] = observed.twist[static_cast<std::size_t>(k)].*axis.part;
  }
  return means;
}

}  // namespace slipwise
