// SPDX-License-Identifier: Apache-2.0
// A slip term: a product of powers of speed, yaw rate, curvature and derivative, that vanishes when the robot is
// parked.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace slipwise {

/// What a slip term may be made of; the body-frame gravity (gx, gy) [m/s^2] is zero on flat terrain.
/// Vy is the speed to the left. V3 is sqrt(V^2 + Vy^2) sin(3 theta) with theta the direction of travel to the x axis:
/// what three omni wheels at equal angles make of the direction. CosYaw and SinYaw are of the heading in the frame of
/// the poses: what a force that is fixed there, such as wind, does to the robot depends on them.
enum class Quantity : std::uint8_t {
  V,
  Omega,
  AbsV,
  AbsOmega,
  SignV,
  Curvature,
  GravityX,
  GravityY,
  CosYaw,
  SinYaw,
  SideV,
  AbsSideV,
  ThirdHarmonic
};
inline constexpr std::size_t kQuantities = 13;
inline bool is_sideways(Quantity quantity) { return quantity >= Quantity::SideV; }
inline bool is_gravity(Quantity quantity) { return quantity == Quantity::GravityX || quantity == Quantity::GravityY; }
inline bool is_heading(Quantity quantity) { return quantity == Quantity::CosYaw || quantity == Quantity::SinYaw; }

/// The state that slip depends on.
struct SlipState {
  double v = 0.0;        ///< [m/s]
  double omega = 0.0;    ///< [rad/s]
  double gx = 0.0;       ///< gravity along the robot's x axis, positive when it points downhill [m/s^2]
  double gy = 0.0;       ///< gravity along the robot's y axis [m/s^2]
  double vy = 0.0;       ///< [m/s], of a robot that drives sideways
  double cos_yaw = 1.0;  ///< of the heading in the frame of the poses
  double sin_yaw = 0.0;
};

/// The quantities of one state, computed once for all terms, with their derivatives by v and omega.
struct SlipQuantities {
  std::array<double, kQuantities> value;
  std::array<double, kQuantities> by_v;
  std::array<double, kQuantities> by_omega;
  std::array<double, kQuantities> by_vy{};

  explicit SlipQuantities(const SlipState& state);

 private:
  void see_sideways(double v, double vy);
};

/// Curvature omega / V is regularised below this speed [m/s]: omega V / (V^2 + kCurvatureSpeed^2).
inline constexpr double kCurvatureSpeed = 0.01;
inline constexpr double kStandardGravity = 9.80665;  ///< [m/s^2]

inline SlipQuantities::SlipQuantities(const SlipState& state) {
  const auto sign = [](double x) { return x > 0.0 ? 1.0 : (x < 0.0 ? -1.0 : 0.0); };
  const double v = state.v, w = state.omega;
  const double moving =
      v != 0.0 || w != 0.0 || state.vy != 0.0 ? 1.0 : 0.0;  // a robot parked on a derivative does not drift
  const double norm = v * v + kCurvatureSpeed * kCurvatureSpeed;
  const double per_w = v / norm;
  value = {v,
           w,
           std::abs(v),
           std::abs(w),
           sign(v),
           w * per_w,
           state.gx * moving,
           state.gy * moving,
           state.cos_yaw,
           state.sin_yaw,
           0.0,
           0.0,
           0.0};
  by_v = {1.0, 0.0, sign(v), 0.0, 0.0, w * (1.0 - 2.0 * v * per_w) / norm, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  by_omega = {0.0, 1.0, 0.0, sign(w), 0.0, per_w, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  if (state.vy != 0.0) {
    see_sideways(v, state.vy);
  }
}

/// A term with its derivatives by speed, yaw rate and sideways speed.
struct TermValue {
  double value;
  double by_v;
  double by_omega;
  double by_vy = 0.0;
};

/// coefficient * product of quantities. Written as text: `V*abs(w)`, `sgn(V)*w^2`, `abs(V)*V*w/g`, `kappa*V`, `gx`.
class Term {
 public:
  /// \throws std::invalid_argument: what is wrong in the text; also for a term that is not zero when the robot is
  /// parked.
  static Term parse(std::string_view text);

  /// The term in its canonical spelling; equal terms have equal text.
  const std::string& text() const { return text_; }

  double coefficient() const { return coefficient_; }
  /// The quantities that are multiplied, each as often as its power says.
  const std::vector<Quantity>& factors() const { return factors_; }

  /// Whether a quantity of driving sideways is among the factors.
  bool sideways() const;
  /// Whether the gravity that pulls the robot is.
  bool by_gravity() const;
  /// Whether the heading in the frame of the poses is.
  bool by_heading() const;

  double value(const SlipQuantities& q) const;
  TermValue linearize(const SlipQuantities& q) const;

 private:
  Term(double coefficient, std::vector<Quantity> factors, std::string text);

  double coefficient_;
  std::vector<Quantity> factors_;
  std::string text_;
};

}  // namespace slipwise
