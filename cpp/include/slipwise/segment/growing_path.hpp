// SPDX-License-Identifier: Apache-2.0
// The path of a segment as it grows by exact steps of SE(2).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "slipwise/segment/integrate_segment.hpp"
#include "slipwise/segment/path_step.hpp"

namespace slipwise {

/// The path as it grows. The heading's rotation is carried along, so that a step costs the trigonometry of its turn
/// alone.
class GrowingPath {
 public:
  GrowingPath(const Segment& segment, std::size_t steps) {
    path_.times.reserve(steps + 1);
    path_.poses.reserve(steps + 1);
    path_.tangents.reserve(steps);
    path_.times.push_back(path_start(segment));
    path_.poses.emplace_back();
  }

  const Eigen::Matrix2d& heading() const { return heading_; }
  const Pose2& pose() const { return path_.poses.back(); }

  /// `displacement` is the step's motion observed from its start, and `arc` belongs to its turn.
  void append(double duration, const Eigen::Vector3d& tangent, const Eigen::Vector2d& displacement,
              const ArcFunctions<double>& arc) {
    const Eigen::Vector2d moved = heading_ * displacement;
    const Pose2 next{pose().x + moved.x(), pose().y + moved.y(), pose().theta + tangent.z()};
    const Eigen::Vector2d ahead = heading_ * Eigen::Vector2d(arc.cos_turn, arc.sin_turn);
    heading_ << ahead.x(), -ahead.y(), ahead.y(), ahead.x();
    path_.times.push_back(path_.times.back() + duration);
    path_.poses.push_back(next);
    path_.tangents.push_back(tangent);
  }

  double time() const { return path_.times.back(); }

  SegmentPath finish(std::vector<ActuatorStep> drive, std::vector<Measured> measured, std::vector<Sight> sights) && {
    path_.drive = std::move(drive);
    path_.measured = std::move(measured);
    path_.sights = std::move(sights);
    return std::move(path_);
  }

 private:
  SegmentPath path_;
  Eigen::Matrix2d heading_ = Eigen::Matrix2d::Identity();
};

/// Appends an exact step; returns the derivative of the pose by the step's tangent, carried back to the path's start:
/// Phi(0, k+1) blkdiag(R_k, 1) E_k of derivations/model.md.
inline Eigen::Matrix3d append_linearized(GrowingPath& path, double duration, const Eigen::Vector3d& tangent) {
  const auto arc = arc_functions(tangent.z());
  const Eigen::Matrix2d heading = path.heading();
  path.append(duration, tangent, arc_matrix(arc) * tangent.head<2>(), arc);
  return start_by_tangent(heading, tangent, arc, path.pose());
}

}  // namespace slipwise
