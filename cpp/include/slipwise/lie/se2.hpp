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
  Eigen::Vector3d error = measured - predicted;
  error.z() = wrap_angle(error.z());
  return error;
}

/// Rotation by `theta` [rad].
inline Eigen::Matrix2d rotation(double theta) {
  const double c = std::cos(theta);
  const double s = std::sin(theta);
  return (Eigen::Matrix2d() << c, -s, s, c).finished();
}

/// Vm of derivations/model.md: the displacement of a unit twist over a turn.
inline Eigen::Matrix2d arc_matrix(const ArcFunctions<double>& arc) {
  return (Eigen::Matrix2d() << arc.a, -arc.b, arc.b, arc.a).finished();
}

/// The pose reached by a constant body twist, tangent = twist * time = (forward, left, turn).
inline Pose2 exp(const Eigen::Vector3d& tangent) {
  const auto arc = arc_functions(tangent.z());
  const Eigen::Vector2d p = arc_matrix(arc) * tangent.head<2>();
  return {p.x(), p.y(), tangent.z()};
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
inline Eigen::Matrix3d adjoint(const Pose2& pose) {
  Eigen::Matrix3d ad = Eigen::Matrix3d::Identity();
  ad.topLeftCorner<2, 2>() = rotation(pose.theta);
  ad(0, 2) = pose.y;
  ad(1, 2) = -pose.x;
  return ad;
}

/// E of derivations/model.md: derivative of the chart (x, y, theta) of exp(tangent) by the tangent; `arc` is of
/// its turn.
inline Eigen::Matrix3d chart_jacobian(const Eigen::Vector3d& tangent, const ArcFunctions<double>& arc) {
  Eigen::Matrix3d e = Eigen::Matrix3d::Identity();
  e.topLeftCorner<2, 2>() = arc_matrix(arc);
  e(0, 2) = arc.da * tangent.x() - arc.db * tangent.y();
  e(1, 2) = arc.db * tangent.x() + arc.da * tangent.y();
  return e;
}

inline Eigen::Matrix3d chart_jacobian(const Eigen::Vector3d& tangent) {
  return chart_jacobian(tangent, arc_functions(tangent.z()));
}

/// Jr: exp(tangent + d) = exp(tangent) exp(Jr d) to first order.
inline Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& tangent) {
  Eigen::Matrix3d jacobian = chart_jacobian(tangent);
  jacobian.topRows<2>() = rotation(-tangent.z()) * jacobian.topRows<2>().eval();
  return jacobian;
}

/// Jl: exp(tangent + d) = exp(Jl d) exp(tangent) to first order.
inline Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& tangent) { return right_jacobian(-tangent); }

/// Phi(b, a) in the world chart: derivative of a later pose of one rollout by an earlier one, exact (thesis 4.8).
inline Eigen::Matrix3d transition(const Pose2& world_a, const Pose2& world_b) {
  Eigen::Matrix3d phi = Eigen::Matrix3d::Identity();
  phi(0, 2) = -(world_b.y - world_a.y);
  phi(1, 2) = world_b.x - world_a.x;
  return phi;
}

}  // namespace slipwise
