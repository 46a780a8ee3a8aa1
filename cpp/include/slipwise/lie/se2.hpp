// SPDX-License-Identifier: Apache-2.0
// SE(2): planar poses whose heading is not wrapped, tangents (x, y, turn), and the Jacobians of the group.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "slipwise/lie/angle.hpp"
#include "slipwise/lie/small_angle.hpp"

namespace slipwise {

/// A planar pose in some frame. The heading counts whole turns: a spin of 400 degrees is not one of 40.
struct Pose2 {
  double x = 0.0;      ///< [m]
  double y = 0.0;      ///< [m]
  double theta = 0.0;  ///< [rad], counter-clockwise, unwrapped

  Eigen::Vector3d vector() const { return {x, y, theta}; }
  static Pose2 from_vector(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
};

/// The residual of a predicted chart (x, y, theta): the turn by its shorter way.
inline Eigen::Vector3d chart_error(const Eigen::Vector3d& measured, const Eigen::Vector3d& predicted) {
  return {measured.x() - predicted.x(), measured.y() - predicted.y(), wrap_angle(measured.z() - predicted.z())};
}

/// (a, -b; b, a), by coefficients: an expression of Eigen would be compiled again wherever this header is included.
inline Eigen::Matrix2d scaled_rotation(double a, double b) {
  Eigen::Matrix2d matrix;
  matrix(0, 0) = a;
  matrix(0, 1) = -b;
  matrix(1, 0) = b;
  matrix(1, 1) = a;
  return matrix;
}

/// Rotation by `theta` [rad].
inline Eigen::Matrix2d rotation(double theta) { return scaled_rotation(std::cos(theta), std::sin(theta)); }

/// Vm of derivations/model.md: the displacement of a unit twist over a turn.
inline Eigen::Matrix2d arc_matrix(const ArcFunctions<double>& arc) { return scaled_rotation(arc.a, arc.b); }

/// The pose reached by a constant body twist, tangent = twist * time = (forward, left, turn).
inline Pose2 exp(const Eigen::Vector3d& tangent) {
  const auto arc = arc_functions(tangent.z());
  return {arc.a * tangent.x() - arc.b * tangent.y(), arc.b * tangent.x() + arc.a * tangent.y(), tangent.z()};
}

/// The constant body twist that reaches `pose` by a turn of at most half a turn: exp(log(pose)) = pose up to whole
/// turns.
inline Eigen::Vector3d log(const Pose2& pose) {
  const double f = wrap_angle(pose.theta);
  const auto arc = arc_functions(f);
  const double scale = 1.0 / (arc.a * arc.a + arc.b * arc.b);
  return {scale * (arc.a * pose.x + arc.b * pose.y), scale * (arc.a * pose.y - arc.b * pose.x), f};
}

/// T_a_c = T_a_b T_b_c; headings add, without wrapping.
inline Pose2 compose(const Pose2& a_b, const Pose2& b_c) {
  const double c = std::cos(a_b.theta);
  const double s = std::sin(a_b.theta);
  return {a_b.x + c * b_c.x - s * b_c.y, a_b.y + s * b_c.x + c * b_c.y, a_b.theta + b_c.theta};
}

inline Pose2 inverse(const Pose2& pose) {
  const double c = std::cos(pose.theta);
  const double s = std::sin(pose.theta);
  return {-c * pose.x - s * pose.y, s * pose.x - c * pose.y, -pose.theta};
}

/// T_a_b from T_w_a and T_w_b: where b is as observed from a.
inline Pose2 between(const Pose2& world_a, const Pose2& world_b) { return compose(inverse(world_a), world_b); }

/// Ad_X: maps a tangent at the robot to the same motion observed from the frame of the pose.
Eigen::Matrix3d adjoint(const Pose2& pose);

/// E of derivations/model.md: derivative of the chart (x, y, theta) of exp(tangent) by the tangent; `arc` is of
/// its turn.
inline Eigen::Matrix3d chart_jacobian(const Eigen::Vector3d& tangent, const ArcFunctions<double>& arc) {
  Eigen::Matrix3d e;
  e(0, 0) = arc.a;
  e(1, 0) = arc.b;
  e(2, 0) = 0.0;
  e(0, 1) = -arc.b;
  e(1, 1) = arc.a;
  e(2, 1) = 0.0;
  e(0, 2) = arc.da * tangent.x() - arc.db * tangent.y();
  e(1, 2) = arc.db * tangent.x() + arc.da * tangent.y();
  e(2, 2) = 1.0;
  return e;
}

inline Eigen::Matrix3d chart_jacobian(const Eigen::Vector3d& tangent) {
  return chart_jacobian(tangent, arc_functions(tangent.z()));
}

/// Jr: exp(tangent + d) = exp(tangent) exp(Jr d) to first order.
Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& tangent);

/// Jl: exp(tangent + d) = exp(Jl d) exp(tangent) to first order.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& tangent);

/// Phi(b, a) in the world chart: derivative of a later pose of one rollout by an earlier one, exact (thesis 4.8).
Eigen::Matrix3d transition(const Pose2& world_a, const Pose2& world_b);

}  // namespace slipwise
