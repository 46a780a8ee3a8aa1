// SPDX-License-Identifier: Apache-2.0
// Steps along tilted ground, written once for numbers and for numbers with derivatives.
#include "slipwise/segment/ground_step.hpp"

#include <algorithm>
#include <cmath>

#include "slipwise/linear/dual_number.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/linear/tuning.hpp"
#include "slipwise/segment/ground_along.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kLongestPiece, 0.1);  // [s] over which the robot's tilt is one
constexpr double kMostPieces = 1000.0;

/// A robot's tilt as the cosine and sine of pitch and roll.
template <class Scalar>
struct TiltAngles {
  Scalar cos_pitch, sin_pitch, cos_roll, sin_roll;
};

template <class Scalar>
TiltAngles<Scalar> tilt_on(const RiseAlong<Scalar>& rise) {
  using std::sqrt;
  const Scalar cos_pitch = Scalar(1.0) / sqrt(Scalar(1.0) + rise.ahead * rise.ahead);
  const Scalar tan_roll = rise.left * cos_pitch;
  const Scalar cos_roll = Scalar(1.0) / sqrt(Scalar(1.0) + tan_roll * tan_roll);
  return {cos_pitch, -(rise.ahead * cos_pitch), cos_roll, tan_roll * cos_roll};
}

/// Rows of `level` on a surface. The robot turns about the surface's normal; where the surface bends along the path,
/// pitching while rolled turns it about the vertical too.
template <class Scalar>
std::array<std::array<Scalar, 3>, 3> level_on(const RiseAlong<Scalar>& rise, const TiltAngles<Scalar>& tilt) {
  const Scalar zero(0.0);
  const Scalar across = tilt.sin_pitch * tilt.sin_roll;
  const Scalar bent = -(tilt.sin_roll * tilt.cos_roll * tilt.cos_pitch);  // turn per change of the rise ahead
  return {{{tilt.cos_pitch, across, zero},
           {zero, tilt.cos_roll, zero},
           {bent * rise.bend_ahead * tilt.cos_pitch, bent * (rise.bend_ahead * across + rise.bend_left * tilt.cos_roll),
            tilt.cos_roll / tilt.cos_pitch}}};
}

template <class Scalar>
std::array<Scalar, 2> gravity_on(const TiltAngles<Scalar>& tilt) {
  const Scalar g(kStandardGravity);
  return {g * tilt.sin_pitch, -(g * tilt.cos_pitch * tilt.sin_roll)};
}

/// Half a step of the drive further than `pose`.
Pose2 middle_of(const ActuatorStep& step, const Pose2& pose) {
  return compose(pose, {0.5 * step.forward, 0.5 * step.left, 0.5 * step.turn});
}

/// What a ground step is made of, in numbers with or without derivatives.
template <class Scalar>
struct StepParts {
  std::array<Scalar, 2> gravity;
  std::array<std::array<Scalar, 3>, 3> level;
  Scalar turned;
};

template <class Scalar>
StepParts<Scalar> measured_parts(const MeasuredTilts& measured, const Scalar& start, const Scalar& duration) {
  using std::cos;
  using std::sin;
  const auto tilt = roll_and_pitch(measured, start + Scalar(0.5) * duration);
  const Scalar pitched = roll_and_pitch(measured, start + duration)[1] - roll_and_pitch(measured, start)[1];
  const TiltAngles<Scalar> at{cos(tilt[1]), sin(tilt[1]), cos(tilt[0]), sin(tilt[0])};
  const Scalar zero(0.0);
  const Scalar vertical = Scalar(1.0) / (at.cos_roll * at.cos_pitch);
  return {gravity_on(at),
          {{{at.cos_pitch, at.sin_pitch * at.sin_roll, zero}, {zero, at.cos_roll, zero}, {zero, zero, vertical}}},
          pitched * at.sin_roll * vertical};
}

template <class Scalar>
StepParts<Scalar> surface_parts(const Ground& ground, const std::array<Scalar, 3>& pose) {
  const auto rise = rise_along(ground, pose);
  const auto tilt = tilt_on(rise);
  return {gravity_on(tilt), level_on(rise, tilt), Scalar(0.0)};
}

template <class Scalar>
GroundStep values_of(const StepParts<Scalar>& parts) {
  GroundStep step{.gravity = {.gx = value_of(parts.gravity[0]), .gy = value_of(parts.gravity[1])},
                  .turned = value_of(parts.turned)};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      step.level(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = value_of(parts.level[i][j]);
    }
  }
  return step;
}

Eigen::RowVector3d derivative_of(const Dual3& number) { return {number.by[0], number.by[1], number.by[2]}; }

GroundStepLinearization linearized(const StepParts<Dual3>& parts) {
  GroundStepLinearization result{.step = values_of(parts),
                                 .level_by = {},
                                 .turned_by = derivative_of(parts.turned),
                                 .gravity_by = Eigen::Matrix<double, 2, 3>::Zero(),
                                 .at_by_pose = Eigen::Matrix3d::Zero(),
                                 .at_by_time = Eigen::Vector3d::Zero(),
                                 .at_by_step = Eigen::Matrix<double, 3, 4>::Zero()};
  result.gravity_by << derivative_of(parts.gravity[0]), derivative_of(parts.gravity[1]);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      result.level_by[i].row(static_cast<Eigen::Index>(j)) = derivative_of(parts.level[i][j]);
    }
  }
  return result;
}

}  // namespace

Eigen::Matrix3d GroundStepLinearization::above_by(const Eigen::Vector3d& tangent) const {
  Eigen::Matrix3d derivative;
  for (Eigen::Index row = 0; row < 3; ++row) {
    derivative.row(row) = tangent.transpose() * level_by[static_cast<std::size_t>(row)];
  }
  derivative.row(2) += turned_by;
  return derivative;
}

std::size_t ground_pieces(double duration) {
  return static_cast<std::size_t>(
      std::min(std::max(1.0, std::ceil((duration - kSameStamp) / kLongestPiece)), kMostPieces));
}

void cut_for_ground(ActuatorSteps& drive) {
  if (std::ranges::all_of(drive.steps, [](const ActuatorStep& step) { return ground_pieces(step.duration) == 1; })) {
    return;
  }
  ActuatorSteps cut;
  for (std::size_t k = 0; k < drive.steps.size(); ++k) {
    const ActuatorStep& step = drive.steps[k];
    const std::size_t pieces = ground_pieces(step.duration);
    const double part = 1.0 / static_cast<double>(pieces);
    for (std::size_t i = 0; i < pieces; ++i) {
      cut.steps.push_back({step.duration * part, step.forward * part, step.left * part, step.turn * part});
      if (!drive.jacobians.empty()) {
        cut.jacobians.emplace_back(drive.jacobians[k] * part);
      }
    }
  }
  drive = std::move(cut);
}

GroundStep ground_step(const Ground& ground, const ActuatorStep& step, const Pose2& pose, double t) {
  if (const auto* tilts = std::get_if<MeasuredTilts>(&ground)) {
    return values_of(measured_parts(*tilts, t, step.duration));
  }
  const Pose2 middle = middle_of(step, pose);
  return values_of(surface_parts<double>(ground, {middle.x, middle.y, middle.theta}));
}

GroundStepLinearization linearize_ground_step(const Ground& ground, const ActuatorStep& step, const Pose2& pose,
                                              double t) {
  if (const auto* tilts = std::get_if<MeasuredTilts>(&ground)) {
    auto at = linearized(measured_parts(*tilts, Dual3::variable(t, 0), Dual3::variable(step.duration, 1)));
    at.at_by_time[0] = 1.0;
    at.at_by_step(1, 0) = 1.0;
    return at;
  }
  const Pose2 middle = middle_of(step, pose);
  auto at = linearized(surface_parts<Dual3>(
      ground, {Dual3::variable(middle.x, 0), Dual3::variable(middle.y, 1), Dual3::variable(middle.theta, 2)}));
  const Eigen::Matrix2d half = 0.5 * rotation(pose.theta);
  const Eigen::Vector2d moved = half * Eigen::Vector2d(step.forward, step.left);
  at.at_by_pose << 1.0, 0.0, -moved.y(), 0.0, 1.0, moved.x(), 0.0, 0.0, 1.0;
  at.at_by_step.block<2, 2>(0, 1) = half;
  at.at_by_step(2, 3) = 0.5;
  return at;
}

Eigen::Matrix3d above_by_place(const GroundStepLinearization& ground, const ActuatorStep& step, const PathSlip& along,
                               const Eigen::Vector3d& body) {
  if (!along.basis.by_gravity()) {
    return ground.above_by(body);
  }
  const auto by_gravity = slip_rate_by_gravity(along.basis, along.alpha, slip_state(step, along.gravity));
  return ground.above_by(body) + ground.step.level * by_gravity * ground.gravity_by * step.duration;
}

Eigen::Matrix<double, 3, 2> slip_rate_by_gravity(const Basis& basis, const Eigen::Ref<const Eigen::VectorXd>& alpha,
                                                 const SlipState& state) {
  const SlipQuantities quantities(state);
  const double moving = state.v != 0.0 || state.omega != 0.0 || state.vy != 0.0 ? 1.0 : 0.0;
  Eigen::Matrix<double, 3, 2> derivative = Eigen::Matrix<double, 3, 2>::Zero();
  for (std::size_t i = 0; i < basis.size(); ++i) {
    double value = basis.terms()[i].coefficient();
    Eigen::RowVector2d by = Eigen::RowVector2d::Zero();
    for (const Quantity factor : basis.terms()[i].factors()) {
      const double x = quantities.value[static_cast<std::size_t>(factor)];
      by *= x;
      by.x() += factor == Quantity::GravityX ? value * moving : 0.0;
      by.y() += factor == Quantity::GravityY ? value * moving : 0.0;
      value *= x;
    }
    derivative.row(static_cast<Eigen::Index>(basis.channel(i))) += alpha[static_cast<Eigen::Index>(i)] * by;
  }
  return derivative;
}

}  // namespace slipwise
