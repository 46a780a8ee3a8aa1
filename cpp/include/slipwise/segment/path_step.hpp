// SPDX-License-Identifier: Apache-2.0
// One step of a path: the slip state it sees, its tangent, and derivatives of both pose and tangent
// (derivations/model.md).
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "slipwise/actuator/actuator_model.hpp"
#include "slipwise/lie/se2.hpp"
#include "slipwise/segment/body_gravity.hpp"
#include "slipwise/slip/slip_surface.hpp"

namespace slipwise {

/// The same of a robot that is headed like this [rad].
inline BodyGravity headed(BodyGravity gravity, double yaw) {
  gravity.cos_yaw = std::cos(yaw);
  gravity.sin_yaw = std::sin(yaw);
  return gravity;
}

/// What slip along a path follows from.
struct PathSlip {
  const Basis& basis;
  Eigen::Ref<const Eigen::VectorXd> alpha;
  BodyGravity gravity;
};

/// The mean drive over a step, which its slip depends on.
inline SlipState slip_state(const ActuatorStep& step, const BodyGravity& gravity) {
  const double rate = step.duration > 0.0 ? 1.0 / step.duration : 0.0;
  return {.v = step.forward * rate,
          .omega = step.turn * rate,
          .gx = gravity.gx,
          .gy = gravity.gy,
          .vy = step.left * rate,
          .cos_yaw = gravity.cos_yaw,
          .sin_yaw = gravity.sin_yaw};
}

/// The same for a step that has no duration yet gains some with the parameters: its integrals grow with its twist.
/// The rows of `jacobian` are duration, forward, left and turn.
template <typename Jacobian>
SlipState slip_state_gained(const Jacobian& jacobian, const BodyGravity& gravity) {
  const double squared = jacobian.row(0).squaredNorm();
  const double per_duration = squared > 0.0 ? 1.0 / squared : 0.0;
  return {.v = jacobian.row(1).dot(jacobian.row(0)) * per_duration,
          .omega = jacobian.row(3).dot(jacobian.row(0)) * per_duration,
          .gx = gravity.gx,
          .gy = gravity.gy,
          .vy = jacobian.row(2).dot(jacobian.row(0)) * per_duration,
          .cos_yaw = gravity.cos_yaw,
          .sin_yaw = gravity.sin_yaw};
}

/// (u_body + du) dt of derivations/model.md.
inline Eigen::Vector3d tangent_of(const ActuatorStep& step, const Eigen::Vector3d& slip) {
  return Eigen::Vector3d(step.forward, step.left, step.turn) + slip * step.duration;
}

/// Three rows with as many columns as a step's Jacobian has.
template <typename Jacobian>
using TangentColumns =
    Eigen::Matrix<double, 3, Jacobian::ColsAtCompileTime, Eigen::ColMajor, 3, Jacobian::MaxColsAtCompileTime>;

/// Runge-Kutta of fourth order on a constant twist: Simpson's rule over the heading (thesis 3.1).
inline Eigen::Vector2d rk4_displacement(const Eigen::Vector3d& tangent) {
  const Eigen::Matrix2d mean = (rotation(0.0) + 4.0 * rotation(tangent.z() / 2.0) + rotation(tangent.z())) / 6.0;
  return mean * tangent.head<2>();
}

/// Derivative of a step's tangent by parameters that move its duration and integrals, and through these its slip, which
/// is `slip` at the step's mean drive.
template <typename Jacobian>
TangentColumns<Jacobian> tangent_by(const ActuatorStep& step, const Jacobian& jacobian, const PathSlip& at,
                                    const Eigen::Vector3d& slip) {
  TangentColumns<Jacobian> result = jacobian.template bottomRows<3>();
  if (!(step.duration > 0.0)) {
    return result + slip_rate(at.basis, at.alpha, slip_state_gained(jacobian, at.gravity)) * jacobian.row(0);
  }
  const SlipState state = slip_state(step, at.gravity);
  const auto by_drive = slip_rate_by_drive(at.basis, at.alpha, state);
  result += slip * jacobian.row(0);
  result += by_drive.col(0) * (jacobian.row(1) - state.v * jacobian.row(0));
  result += by_drive.col(1) * (jacobian.row(3) - state.omega * jacobian.row(0));
  if (at.basis.sideways()) {
    result += slip_rate_by_sideways(at.basis, at.alpha, state) * (jacobian.row(2) - state.vy * jacobian.row(0));
  }
  return result;
}

/// Derivative of the pose `next` by the tangent of the step that led to it, carried back to the path's start:
/// Phi(0, k+1) blkdiag(R_k, 1) E_k of derivations/model.md. `heading` is R_k; `arc` is of the step's turn.
inline Eigen::Matrix3d start_by_tangent(const Eigen::Matrix2d& heading, const Eigen::Vector3d& tangent,
                                        const ArcFunctions<double>& arc, const Pose2& next) {
  Eigen::Matrix3d world = chart_jacobian(tangent, arc);
  world.topRows<2>() = (heading * world.topRows<2>()).eval();
  world(0, 2) += next.y;
  world(1, 2) -= next.x;
  return world;
}

}  // namespace slipwise
