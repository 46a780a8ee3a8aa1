// SPDX-License-Identifier: Apache-2.0
// A mean of what poses say of a later one, older poses counting less, for several memories at once.
#include "slipwise/estimate/start_pose.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/lie/angle.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

constexpr double kReach = 4.0;  // memories; what is older would count less than 2 %

/// A pose beside where the model says it was, both as seen from the last one.
struct Carried {
  double age;                ///< [s]
  Eigen::Vector2d measured;  ///< [m]
  Eigen::Vector2d modelled;  ///< [m]
  double missed_turn;        ///< of the measured heading over the modelled one [rad]
};

Pose2 sensor_at(const SegmentPath& path, double time) {
  const auto after = std::ranges::upper_bound(path.times, time);
  const std::ptrdiff_t last = std::ssize(path.tangents) - 1;
  const std::ptrdiff_t step = std::clamp<std::ptrdiff_t>(after - path.times.begin() - 1, 0, last);
  const auto i = static_cast<std::size_t>(step);
  const double share = (time - path.times[i]) / (path.times[i + 1] - path.times[i]);
  return compose(compose(path.poses[i], exp(share * path.tangents[i])), path.sensor);
}

void check_seen(const SeenPoses& seen, const Segment& segment) {
  if (seen.stamps.size() != seen.poses.size()) {
    throw std::invalid_argument("each pose before a start needs a stamp, got " + std::to_string(seen.stamps.size()) +
                                " stamps and " + std::to_string(seen.poses.size()) + " poses");
  }
  const auto not_later = [](double one, double next) { return !(one < next); };  // true for NaN too
  const bool increase = std::ranges::adjacent_find(seen.stamps, not_later) == seen.stamps.end();
  const bool finite = std::ranges::all_of(seen.stamps, [](double stamp) { return std::isfinite(stamp); });
  if (!increase || !finite || (!seen.stamps.empty() && seen.stamps.back() != segment.start)) {
    throw std::invalid_argument("the stamps of poses before a start must increase, and the last must be the start");
  }
}

/// From a window to the stretch before it that ends at its start.
Segment stretch_before(const Segment& window, double since) {
  Segment before = window;
  before.start = since;
  before.end = window.start;
  before.measured = {};
  if (!before.known) {
    before.initial.reset();  // it was measured at the window's start
  }
  return before;
}

std::vector<Carried> carried_back(const MotionPosterior& belief, const InputTrack& inputs, const SeenPoses& seen,
                                  const Segment& segment) {
  check_seen(seen, segment);
  std::vector<Carried> result;
  if (seen.poses.size() < 2) {
    return result;
  }
  const Segment before = stretch_before(segment, seen.stamps.front());
  const SegmentPath path = integrate_segment(belief.model, belief.estimate.mean, inputs, before);
  const Pose2 last = sensor_at(path, segment.start);
  for (std::size_t i = 0; i < seen.poses.size(); ++i) {
    const Pose2 measured = between(seen.poses.back(), seen.poses[i]);
    const Pose2 modelled = between(last, sensor_at(path, seen.stamps[i]));
    result.push_back({segment.start - seen.stamps[i], measured.vector().head<2>(), modelled.vector().head<2>(),
                      wrap_angle(measured.theta - modelled.theta)});
  }
  return result;
}

Pose2 mean_start(const std::vector<Carried>& carried, double memory) {
  if (memory == 0.0 || carried.empty()) {
    return {};
  }
  double sum = 0.0;
  double turn = 0.0;
  for (const Carried& pose : carried) {
    sum += std::exp(-pose.age / memory);
    turn += std::exp(-pose.age / memory) * pose.missed_turn;
  }
  turn /= sum;
  const Eigen::Matrix2d turned = rotation(turn);
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  for (const Carried& pose : carried) {
    position += std::exp(-pose.age / memory) / sum * (pose.measured - turned * pose.modelled);
  }
  return {position.x(), position.y(), turn};
}

void check_memories(const std::vector<double>& memories) {
  for (const double memory : memories) {
    if (!(memory > 0.0) || !std::isfinite(memory)) {
      throw std::invalid_argument("the memories of a start must be positive and finite, got " + std::to_string(memory));
    }
  }
}

}  // namespace

StartPose::StartPose(const StartPoseSettings& settings) : weighing_(settings.weighing) {
  check_memories(settings.memories);
  law_.memories = settings.memories;
  law_.memories.insert(law_.memories.begin(), 0.0);
  const auto count = static_cast<Eigen::Index>(law_.memories.size());
  prior_ = Eigen::VectorXd::Constant(count, (1.0 - settings.measured) / std::max(1.0, static_cast<double>(count - 1)));
  prior_[0] = count > 1 ? settings.measured : 1.0;
  law_.weights = prior_;
}

StartPose::StartPose(StartLaw law) : law_(std::move(law)) {
  const bool memories = std::ranges::all_of(law_.memories, [](double m) { return m >= 0.0 && std::isfinite(m); });
  if (std::ssize(law_.memories) != law_.weights.size() || !memories || !(law_.weights.array() >= 0.0).all()) {
    throw std::invalid_argument("each memory of a start needs a weight, and none of either may be negative");
  }
  if (!law_.memories.empty() && !(std::abs(law_.weights.sum() - 1.0) <= 1e-6)) {
    throw std::invalid_argument("the weights of the memories of a start must sum to 1");
  }
  prior_ = law_.weights;
}

void StartPose::learn(const MotionPosterior& belief, const InputTrack& inputs, const SeenPoses& seen,
                      const Segment& segment, const ExpectedPose& expected) {
  const std::vector<Carried> carried = carried_back(belief, inputs, seen, segment);
  if (carried.empty()) {
    return;
  }
  std::vector<Eigen::Vector3d> innovations;
  for (const double memory : law_.memories) {
    const ExpectedPose moved = starting_at(mean_start(carried, memory), expected);
    innovations.emplace_back(segment.measured.vector() - moved.pose);
    innovations.back().z() = wrap_angle(innovations.back().z());
  }
  const std::vector<Eigen::Matrix3d> covariances(innovations.size(), expected.covariance);
  const Eigen::VectorXd scores = common_log_scores(law_.weights, innovations, covariances);
  law_.weights = reweighed(law_.weights, scores, prior_, weighing_, seen_);
  ++seen_;
}

Pose2 StartPose::offset(const MotionPosterior& belief, const InputTrack& inputs, const SeenPoses& seen,
                        const Segment& segment) const {
  const std::vector<Carried> carried = carried_back(belief, inputs, seen, segment);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < law_.memories.size(); ++i) {
    mean += law_.weights[static_cast<Eigen::Index>(i)] * mean_start(carried, law_.memories[i]).vector();
  }
  return Pose2::from_vector(mean);
}

double StartPose::reach() const { return kReach * (law_.memories.empty() ? 0.0 : std::ranges::max(law_.memories)); }

ExpectedPose starting_at(const Pose2& offset, const ExpectedPose& expected) {
  Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();
  turned.topLeftCorner<2, 2>() = rotation(offset.theta);
  return {compose(offset, Pose2::from_vector(expected.pose)).vector(),
          turned * expected.covariance * turned.transpose()};
}

}  // namespace slipwise
