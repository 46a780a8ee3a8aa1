// SPDX-License-Identifier: Apache-2.0
// The sliding-mode observer: one switching law per sliding surface.
#include "slipwise/thesis/sliding_mode_observer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

constexpr double kLargestTurn = 3.0;  // rad; the mean twist of a longer turn does not follow from its end

/// How far a slip moves in a segment. The surface changes by -`lever` per unit of slip, and `most` is the full step.
double switched(double surface, double lever, double layer, double most) {
  const double width = layer + 2.0 * most * std::abs(lever);
  return -std::copysign(most, lever) * std::clamp(surface / width, -1.0, 1.0);
}

/// Left side, right side and sideways speed of a mean body twist.
Eigen::Vector3d surface_speeds(const Eigen::Vector3d& twist, double wheel_separation) {
  const double turn = twist.z() * wheel_separation / 2.0;
  return {twist.x() - turn, twist.x() + turn, twist.y()};
}

Eigen::Vector3d mean_twist_at_wheels(const SegmentPath& path, double duration) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ActuatorStep& step : path.drive) {
    sum += Eigen::Vector3d(step.forward, step.left, step.turn);
  }
  return sum / duration;
}

}  // namespace

SlidingModeObserver::SlidingModeObserver(const SlidingModeSettings& settings) : settings_(settings) {
  for (const double value : {settings.wheel_separation, settings.ratio_gain, settings.angle_gain, settings.side_layer,
                             settings.drift_layer, settings.slowest}) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      throw std::invalid_argument(
          "wheel separation, gains, layers and the slowest speed of the observer must be positive");
    }
  }
}

SlidingModeUpdate SlidingModeObserver::learn(const InputHistory& wheels, const Segment& segment) {
  const double duration = segment.end - segment.start;
  if (!(duration > 0.0) || !motion_of(segment.measured).vector().allFinite()) {
    throw std::invalid_argument("a segment must end after it starts and have finite measurements");
  }
  const SegmentPath path = integrate_segment(slip_ratio_model(), linear_mean(), wheels, segment);
  const Pose2& predicted = path.poses.back();
  const Pose2 measured = motion_of(segment.measured);
  if (std::abs(measured.theta) > kLargestTurn || std::abs(predicted.theta) > kLargestTurn) {
    return {.surface = Eigen::Vector3d::Zero(), .used = false};
  }
  const Eigen::Vector3d measured_twist = log(path.robot_motion(measured)) / duration;
  const Eigen::Vector3d predicted_twist = log(predicted) / duration;
  const Eigen::Vector3d surface = surface_speeds(measured_twist - predicted_twist, settings_.wheel_separation);
  const Eigen::Vector3d rims = surface_speeds(mean_twist_at_wheels(path, duration), settings_.wheel_separation);
  const double ratio_step = settings_.ratio_gain * duration;
  SlipRatios next = slip_;
  if (std::abs(rims[0]) > settings_.slowest) {
    next.left += switched(surface[0], rims[0], settings_.side_layer, ratio_step);
  }
  if (std::abs(rims[1]) > settings_.slowest) {
    next.right += switched(surface[1], rims[1], settings_.side_layer, ratio_step);
  }
  if (const double vx = predicted_twist.x(); std::abs(vx) > settings_.slowest) {
    const double lever = vx * (1.0 + std::pow(std::tan(slip_.angle), 2));
    next.angle += switched(surface[2], lever, settings_.drift_layer, settings_.angle_gain * duration);
  }
  slip_ = bounded(next);
  return {.surface = surface, .used = true};
}

}  // namespace slipwise
