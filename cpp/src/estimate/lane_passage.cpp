// SPDX-License-Identifier: Apache-2.0
// A lane by the logarithms of its times, with the deviation beside its chain.
#include "slipwise/estimate/lane_passage.hpp"

#include <algorithm>
#include <cmath>

#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kSlowRange, 0.3);  // of the speed range, that the slow part may hold

/// The fastest that the lane was told to go, or went.
double fastest(const ChannelWindow& window, const ActuatorAxis& lane) {
  const auto& [inputs, seen] = window;
  double speed = 0.0;
  for (const BodyTwist& twist : seen.twist) {
    speed = std::max(speed, std::abs(twist.*lane.part));
  }
  const std::size_t until = inputs.count_until(seen.edges.back());
  const std::size_t from = inputs.count_until(seen.edges.front() - lane.delay);
  for (std::size_t k = std::max<std::size_t>(from, 1) - 1; k < until; ++k) {
    speed = std::max(speed, std::abs(inputs.sample(k).*lane.part));
  }
  return speed;
}

}  // namespace

ActuatorAxis lane_of(double BodyTwist::* part, const ChannelParameters& parameters) {
  return {part,
          {.gain = parameters[2],
           .lag = std::exp(parameters[0]),
           .slow_share = parameters[3],
           .slow_lag = std::exp(parameters[4])},
          std::exp(parameters[1])};
}

std::optional<FirstLaneState> first_state(const ChannelWindow& window, const ActuatorAxis& lane, double wander) {
  const double range = fastest(window, lane);
  if (!(range > 0.0)) {
    return std::nullopt;
  }
  const AxisState settled = settled_axis(window.inputs, lane, window.seen.edges.front());
  return FirstLaneState{{settled.fast, settled.slow, 0.0}, {range * range, std::pow(kSlowRange * range, 2), wander}};
}

AxisMotion lane_through(const ChannelWindow& window, const ActuatorAxis& lane, const AxisState& start) {
  AxisMotion motion = axis_motion(window.inputs, lane, start, window.seen.edges);
  motion.slope.col(0) *= lane.response.lag;
  motion.slope.col(1) *= lane.delay;
  motion.slope.col(4) *= lane.response.slow_lag;
  return motion;
}

LanePassage lane_passage(const ChannelWindow& window, const ActuatorAxis& lane, const LaneVector& start,
                         const DriveNoiseMeans& noise) {
  const AxisMotion motion = lane_through(window, lane, {.fast = start[0], .slow = start[1]});
  const Eigen::Index rows = motion.value.size() + 1;
  const Eigen::Index k = rows - kLaneStates;
  LanePassage passage{Eigen::VectorXd(rows), Eigen::Matrix<double, Eigen::Dynamic, kChannelParameters>(rows, 5),
                      Eigen::Matrix<double, Eigen::Dynamic, kLaneStates>::Zero(rows, 3)};
  passage.value << motion.value, noise.by_start[k] * start[2];
  passage.value.head(k) += noise.by_start.head(k) * start[2];
  passage.by_chain << motion.slope.leftCols<kChannelParameters>(), Eigen::RowVectorXd::Zero(kChannelParameters);
  passage.by_state.topLeftCorner(rows - 1, 2) = motion.slope.rightCols<2>();
  passage.by_state.col(2).head(k) = noise.by_start.head(k);
  passage.by_state(rows - 1, 2) = noise.by_start[k];
  return passage;
}

Eigen::VectorXd lane_means(const WheelMeans& seen, const ActuatorAxis& lane) {
  Eigen::VectorXd means(std::ssize(seen.twist));
  for (Eigen::Index k = 0; k < means.size(); ++k) {
    means[k] = seen.twist[static_cast<std::size_t>(k)].*lane.part;
  }
  return means;
}

}  // namespace slipwise
