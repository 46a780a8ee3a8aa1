// SPDX-License-Identifier: Apache-2.0
// Any set of wheels: body twist from wheel and steering readings by least squares, and wheels for a body twist
// (derivations/sensors.md).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slipwise/lie/body_twist.hpp"

namespace slipwise {

/// Joint about which a part of an articulated vehicle turns; base_link is on the other part.
struct Hinge {
  double x = 0.0;  ///< ahead of base_link [m]
  double y = 0.0;  ///< [m]
};

/// One wheel on the ground. A plain wheel rolls along its direction and does not move across it. One with rollers, or
/// one that slides across as the wheels of skid steering do, tells its speed along the rollers' axes alone.
struct Wheel {
  double x = 0.0;                  ///< of the contact, ahead of base_link [m]
  double y = 0.0;                  ///< to the left [m]
  double radius = 0.0;             ///< [m]
  double angle = 0.0;              ///< direction it rolls in while its steering reads 0, to the left of x [rad]
  std::optional<double> roller{};  ///< axes of its rollers, to the left of its direction [rad]; 0: omni, or it slides
  bool steered = false;            ///< its steering angle is a reading, and free to be commanded
  bool behind_hinge = false;       ///< x, y, angle hold while the hinge reads 0; otherwise it is turned with it
  std::optional<Hinge> pivot{};    ///< its steering turns it about this, while x, y hold at 0; none: about its contact
};

/// How far a reading and what a wheel does come apart, one standard deviation.
struct WheelNoise {
  double rolling = 0.02;   ///< along the rollers' axes, or a plain wheel's direction [m/s]
  double sideways = 0.02;  ///< across a plain wheel [m/s]
};

/// What was read at one moment. A speed that is NaN was not read: the wheel then tells only that it does not move
/// across.
struct WheelReadings {
  Eigen::VectorXd speed;     ///< [wheels], [rad/s]
  Eigen::VectorXd steering;  ///< [wheels], [rad]; that of a wheel which is not steered is ignored
  double hinge = 0.0;        ///< how far the part behind the hinge is turned, to the left [rad]
  double hinge_rate = 0.0;   ///< [rad/s]
  Eigen::VectorXd
      steering_rate{};  ///< [wheels], [rad/s], that of a wheel without a pivot is ignored; empty: none turns
};

/// A body twist (v, vy, omega) and what the readings say against it.
struct WheelTwist {
  BodyTwist twist;
  Eigen::Matrix3d covariance;  ///< of the twist; larger where readings contradict each other
  Eigen::VectorXd residual;    ///< [rows], reading less what the twist makes of it [m/s]
  double chi2 = 0.0;           ///< squares of the residuals in standard deviations
  Eigen::Index freedom = 0;    ///< rows more than a twist needs; chi2 is about this where nothing slips
};

/// What wheels must do to make a twist.
struct WheelTargets {
  Eigen::VectorXd speed;     ///< [wheels], [rad/s]
  Eigen::VectorXd steering;  ///< [wheels], [rad], within a quarter turn of where the wheel is
  Eigen::VectorXd across;    ///< [wheels], [m/s], what a plain wheel would have to slide
};

class WheelLayout {
 public:
  /// \throws std::invalid_argument when a number makes no sense, or the wheels do not tell a twist.
  explicit WheelLayout(std::vector<Wheel> wheels, const WheelNoise& noise = {}, std::optional<Hinge> hinge = {});

  const std::vector<Wheel>& wheels() const { return wheels_; }
  bool hinged() const { return hinge_.has_value(); }
  /// Whether steering moves a contact: then its rate counts.
  bool pivoted() const;
  /// Wheels that all slide across, as in skid steering, do not tell vy: it is taken as 0, and slip terms say the rest.
  bool tells_sideways() const { return tells_sideways_; }

  /// Weighted least squares over all rows. \throws std::invalid_argument when readings have another length, are not
  /// finite, or are too few for a twist.
  WheelTwist twist(const WheelReadings& readings) const;

  /// The inverse. `now` is where steering and hinge are; its speeds are ignored. A steered wheel points to where it
  /// rolls without sliding once its steering rests.
  WheelTargets wheels_for(const BodyTwist& twist, const WheelReadings& now) const;

 private:
  void check(const WheelReadings& readings) const;

  std::vector<Wheel> wheels_;
  WheelNoise noise_;
  std::optional<Hinge> hinge_;
  bool tells_sideways_ = true;
};

}  // namespace slipwise
