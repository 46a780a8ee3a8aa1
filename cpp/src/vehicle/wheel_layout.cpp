// SPDX-License-Identifier: Apache-2.0
// Wheels to twist and back: one linear measurement of (v, vy, omega) per rolling constraint (derivations/sensors.md).
#include "slipwise/vehicle/wheel_layout.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

namespace slipwise {
namespace {

/// Singular directions below this part of the largest pivot tell nothing.
constexpr double kRankTolerance = 1e-9;
/// A contact slower than this points nowhere: the wheel stays as it is [m/s].
constexpr double kStandstill = 1e-9;

Eigen::Vector2d direction(double angle) { return {std::cos(angle), std::sin(angle)}; }
Eigen::Vector2d left_of(const Eigen::Vector2d& a) { return {-a.y(), a.x()}; }

Eigen::Vector2d turned_by(double angle, const Eigen::Vector2d& a) {
  const Eigen::Vector2d along = direction(angle);
  return along * a.x() + left_of(along) * a.y();
}

/// Where a wheel is and points.
struct Placed {
  Eigen::Vector2d at;                             ///< contact in base_link [m]
  Eigen::Vector2d swing;                          ///< contact velocity because hinge and steering turn [m/s]
  double heading;                                 ///< it rolls in [rad]
  Eigen::Vector2d arm = Eigen::Vector2d::Zero();  ///< from the pivot of its steering to the contact [m]
  double arm_rate = 0.0;                          ///< the arm turns against base_link [rad/s]
};

Placed placed(const Wheel& wheel, const std::optional<Hinge>& hinge, double steering, double steering_rate,
              const WheelReadings& now) {
  Placed result{{wheel.x, wheel.y}, Eigen::Vector2d::Zero(), wheel.angle + (wheel.steered ? steering : 0.0)};
  if (wheel.steered && wheel.pivot) {
    const Eigen::Vector2d pivot(wheel.pivot->x, wheel.pivot->y);
    result.arm = turned_by(steering, result.at - pivot);
    result.arm_rate = steering_rate;
    result.at = pivot + result.arm;
    result.swing = steering_rate * left_of(result.arm);
  }
  if (wheel.behind_hinge && hinge) {
    const Eigen::Vector2d joint(hinge->x, hinge->y);
    const Eigen::Vector2d turned = turned_by(now.hinge, result.at - joint);
    result.at = joint + turned;
    result.swing = now.hinge_rate * left_of(turned) + turned_by(now.hinge, result.swing);
    result.heading += now.hinge;
    result.arm = turned_by(now.hinge, result.arm);
    result.arm_rate += now.hinge_rate;
  }
  return result;
}

Eigen::RowVector3d velocity_along(const Eigen::Vector2d& at, const Eigen::Vector2d& along) {
  return {along.x(), along.y(), along.y() * at.x() - along.x() * at.y()};
}

bool finite(double value) { return std::isfinite(value); }

double steering_rate_of(const WheelReadings& readings, Eigen::Index wheel) {
  return readings.steering_rate.size() > 0 ? readings.steering_rate[wheel] : 0.0;
}

void check_wheel(const Wheel& wheel, bool hinged) {
  if (!finite(wheel.x) || !finite(wheel.y) || !finite(wheel.angle) || !(wheel.radius > 0.0) || !finite(wheel.radius)) {
    throw std::invalid_argument("a wheel needs a finite position and angle, and a positive radius [m]");
  }
  if (wheel.roller && !(std::abs(std::cos(*wheel.roller)) > 0.1)) {
    throw std::invalid_argument("axes of rollers must not lie across the wheel; 0 is an omni wheel, 0.7854 mecanum");
  }
  if (wheel.pivot && (!wheel.steered || !finite(wheel.pivot->x) || !finite(wheel.pivot->y))) {
    throw std::invalid_argument("a pivot is finite [m] and of a wheel that is steered");
  }
  if (wheel.behind_hinge && !hinged) {
    throw std::invalid_argument("a wheel is behind a hinge, but there is no hinge; say where it is");
  }
}

/// One constraint: a velocity of a contact along a direction is what is read.
struct Row {
  Eigen::RowVector3d of_twist;  ///< derivative of the velocity by the twist
  double reading = 0.0;         ///< [m/s]
  double weight = 1.0;          ///< 1 / standard deviation
};

/// Sideways motion is taken as none, where no wheel tells it.
Row no_sideways(const WheelNoise& noise) { return {.of_twist = {0.0, 1.0, 0.0}, .weight = 1.0 / noise.sideways}; }

std::vector<Row> rows_of(const std::vector<Wheel>& wheels, const WheelNoise& noise, const std::optional<Hinge>& hinge,
                         const WheelReadings& readings) {
  std::vector<Row> rows;
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    const Wheel& wheel = wheels[i];
    const auto place = static_cast<Eigen::Index>(i);
    const Placed at = placed(wheel, hinge, readings.steering[place], steering_rate_of(readings, place), readings);
    const auto add = [&](double angle, double std, double by_speed) {
      const Eigen::Vector2d along = direction(angle);
      const double speed = by_speed != 0.0 ? by_speed * readings.speed[place] : 0.0;
      rows.push_back(
          {.of_twist = velocity_along(at.at, along), .reading = speed - along.dot(at.swing), .weight = 1.0 / std});
    };
    const double roller = wheel.roller.value_or(0.0);
    if (finite(readings.speed[place])) {
      add(at.heading + roller, noise.rolling, wheel.radius * std::cos(roller));
    }
    if (!wheel.roller) {
      add(at.heading + std::numbers::pi / 2.0, noise.sideways, 0.0);
    }
  }
  return rows;
}

/// The rows as a weighted linear system.
struct System {
  Eigen::MatrixX3d a;
  Eigen::VectorXd b, weight;
  Eigen::ColPivHouseholderQR<Eigen::MatrixX3d> qr;

  explicit System(const std::vector<Row>& rows) {
    const auto count = static_cast<Eigen::Index>(rows.size());
    a.resize(count, 3);
    b.resize(count);
    weight.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Row& row = rows[static_cast<std::size_t>(i)];
      a.row(i) = row.of_twist;
      b[i] = row.reading;
      weight[i] = row.weight;
    }
    if (count > 0) {
      qr.compute(weight.asDiagonal() * a);
      qr.setThreshold(kRankTolerance);
    }
  }

  bool tells_twist() const { return a.rows() >= 3 && qr.rank() == 3; }
};

/// Steered wheels may stand in line with each other at 0: they must tell a twist there or a little further.
bool tell_twist(const std::vector<Wheel>& wheels, const std::optional<Hinge>& hinge, bool sideways_known) {
  const auto count = static_cast<Eigen::Index>(wheels.size());
  return std::ranges::any_of(std::array{0.0, 0.3}, [&](double steering) {
    auto rows =
        rows_of(wheels, {}, hinge,
                {.speed = Eigen::VectorXd::Zero(count), .steering = Eigen::VectorXd::Constant(count, steering)});
    if (sideways_known) {
      rows.push_back(no_sideways({}));
    }
    return System(rows).tells_twist();
  });
}

Eigen::Vector2d contact_velocity(const Placed& wheel, const BodyTwist& twist) {
  return Eigen::Vector2d(twist.v, twist.vy) + twist.omega * left_of(wheel.at) + wheel.swing;
}

/// How far to turn the steering until the wheel rolls without sliding, forwards or backwards, whichever is nearer
/// [rad]. A contact that trails its pivot by e rolls where the pivot's velocity c leans by asin(e omega / |c|) to it.
double turn_to_roll(const Placed& wheel, const BodyTwist& twist) {
  const double turning = twist.omega + wheel.arm_rate;
  const Eigen::Vector2d moves = contact_velocity(wheel, twist) - turning * left_of(wheel.arm);  // of the pivot
  if (!(moves.norm() > kStandstill)) {
    return 0.0;
  }
  const double ahead = wheel.arm.dot(direction(wheel.heading));
  const double along = std::atan2(moves.y(), moves.x()) - wheel.heading;
  const double lean = std::asin(std::clamp(turning * ahead / moves.norm(), -1.0, 1.0));
  if (lean == 0.0) {
    return std::remainder(along, std::numbers::pi);
  }
  const double forwards = std::remainder(along + lean, 2.0 * std::numbers::pi);
  const double backwards = std::remainder(along + std::numbers::pi - lean, 2.0 * std::numbers::pi);
  return std::abs(forwards) <= std::abs(backwards) ? forwards : backwards;
}

WheelTwist solved(const System& system) {
  const Eigen::Vector3d t = system.qr.solve(system.weight.cwiseProduct(system.b));
  WheelTwist found;
  found.twist = {.v = t[0], .vy = t[1], .omega = t[2]};
  found.residual = system.b - system.a * t;
  found.chi2 = system.weight.cwiseProduct(found.residual).squaredNorm();
  found.freedom = system.a.rows() - 3;
  // Contradiction beyond the stated noise widens the covariance (Birge 1932); agreement does not narrow it.
  const double ratio = found.freedom > 0 ? found.chi2 / static_cast<double>(found.freedom) : 1.0;
  const Eigen::Matrix3d information = system.a.transpose() * system.weight.cwiseAbs2().asDiagonal() * system.a;
  found.covariance = information.inverse() * std::max(ratio, 1.0);
  return found;
}

}  // namespace

WheelLayout::WheelLayout(std::vector<Wheel> wheels, const WheelNoise& noise, std::optional<Hinge> hinge)
    : wheels_(std::move(wheels)), noise_(noise), hinge_(hinge) {
  if (!(noise_.rolling > 0.0) || !(noise_.sideways > 0.0) || !finite(noise_.rolling) || !finite(noise_.sideways)) {
    throw std::invalid_argument("standard deviations of wheels must be positive [m/s]; 0.02 is usual");
  }
  if (hinge_ && !(finite(hinge_->x) && finite(hinge_->y))) {
    throw std::invalid_argument("a hinge needs a finite position [m]");
  }
  for (const Wheel& wheel : wheels_) {
    check_wheel(wheel, hinge_.has_value());
  }
  tells_sideways_ = tell_twist(wheels_, hinge_, false);
  if (!tells_sideways_ && !tell_twist(wheels_, hinge_, true)) {
    throw std::invalid_argument("these wheels do not tell a motion; give at least two that are apart");
  }
}

void WheelLayout::check(const WheelReadings& readings) const {
  const auto count = static_cast<Eigen::Index>(wheels_.size());
  if (readings.speed.size() != count || readings.steering.size() != count) {
    throw std::invalid_argument("one speed and one steering angle per wheel are needed: " + std::to_string(count));
  }
  if (!finite(readings.hinge) || !finite(readings.hinge_rate)) {
    throw std::invalid_argument("the hinge's angle and rate must be finite [rad, rad/s]");
  }
  const Eigen::Index rates = readings.steering_rate.size();
  if (rates != 0 && rates != count) {
    throw std::invalid_argument("one steering rate per wheel is needed, or none: " + std::to_string(count));
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    const Wheel& wheel = wheels_[static_cast<std::size_t>(i)];
    const double rate = wheel.pivot ? steering_rate_of(readings, i) : 0.0;
    if (wheel.steered && (!finite(readings.steering[i]) || !finite(rate))) {
      throw std::invalid_argument("the angle of a steered wheel, and its rate, must be finite [rad, rad/s]");
    }
  }
}

bool WheelLayout::pivoted() const {
  return std::ranges::any_of(wheels_, [](const Wheel& wheel) { return wheel.pivot.has_value(); });
}

WheelTwist WheelLayout::twist(const WheelReadings& readings) const {
  check(readings);
  auto rows = rows_of(wheels_, noise_, hinge_, readings);
  if (!tells_sideways_) {
    rows.push_back(no_sideways(noise_));
  }
  const System system(rows);
  if (!system.tells_twist()) {
    throw std::invalid_argument("the readings of this moment do not tell a motion; too few wheels were read");
  }
  return solved(system);
}

WheelTargets WheelLayout::wheels_for(const BodyTwist& twist, const WheelReadings& now) const {
  check(now);
  const auto count = static_cast<Eigen::Index>(wheels_.size());
  WheelTargets targets{Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const Wheel& wheel = wheels_[static_cast<std::size_t>(i)];
    if (wheel.steered) {
      const Placed resting = placed(wheel, hinge_, now.steering[i], 0.0, now);
      targets.steering[i] = now.steering[i] + turn_to_roll(resting, twist);
    }
    const Placed at = placed(wheel, hinge_, targets.steering[i], steering_rate_of(now, i), now);
    const Eigen::Vector2d moves = contact_velocity(at, twist);
    const double roller = wheel.roller.value_or(0.0);
    targets.speed[i] = moves.dot(direction(at.heading + roller)) / (wheel.radius * std::cos(roller));
    targets.across[i] = wheel.roller ? 0.0 : moves.dot(left_of(direction(at.heading)));
  }
  return targets;
}

}  // namespace slipwise
