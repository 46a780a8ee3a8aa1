// SPDX-License-Identifier: Apache-2.0
// Paths over tilted ground: against planes, against rotations in space integrated in small steps, and their
// derivatives.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "finite_difference.hpp"
#include "sample_bases.hpp"
#include "sample_drives.hpp"
#include "slipwise/segment/ground_step.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

constexpr double kStart = 1.0131;
constexpr double kEnd = 4.0177;

Eigen::Matrix3d turned(double roll, double pitch, double yaw) {
  return (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

/// Roll and pitch at a pose (x, y, yaw) and a time.
using Attitude = std::function<Eigen::Vector2d(const Eigen::Vector3d& pose, double t)>;

/// Where a twist leads whose robot keeps to the attitude: the yaw rate about the vertical is the one with which the
/// rotation in space turns by omega about the robot's own z axis. Midpoint steps of 0.2 ms.
Eigen::Vector3d path_in_space(const Attitude& attitude, tests::TwistOfTime twist, double start, double end) {
  const auto rate = [&](const Eigen::Vector3d& pose, double t) -> Eigen::Vector3d {
    const BodyTwist body = twist(t);
    const Eigen::Vector2d now = attitude(pose, t);
    const Eigen::Matrix3d orientation = turned(now[0], now[1], pose[2]);
    const Eigen::Vector3d moved = orientation * Eigen::Vector3d(body.v, body.vy, 0.0);
    const auto own_turn = [&](double yaw_rate) {
      constexpr double kTiny = 1e-6;
      const Eigen::Vector3d later = pose + kTiny * Eigen::Vector3d(moved.x(), moved.y(), yaw_rate);
      const Eigen::Vector2d then = attitude(later, t + kTiny);
      const Eigen::Matrix3d change = orientation.transpose() * turned(then[0], then[1], later[2]);
      return 0.5 * (change(1, 0) - change(0, 1)) / kTiny;
    };
    const double without = own_turn(0.0);
    return {moved.x(), moved.y(), (body.omega - without) / (own_turn(1.0) - without)};
  };
  constexpr int kSteps = 15000;
  const double dt = (end - start) / kSteps;
  Eigen::Vector3d pose = Eigen::Vector3d::Zero();
  for (int i = 0; i < kSteps; ++i) {
    const double t = start + dt * i;
    pose += dt * rate(pose + 0.5 * dt * rate(pose, t), t + 0.5 * dt);
  }
  return pose;
}

InputHistory finely_sampled(tests::TwistOfTime twist) { return tests::sampled(twist, 0.0, 0.002, 3000); }

Eigen::Vector3d end_of(const Ground& ground, tests::TwistOfTime twist) {
  const MotionModel model(named_basis("edd-2"), {});
  Segment segment{.start = kStart, .end = kEnd};
  segment.ground = std::make_shared<const Ground>(ground);
  return integrate_segment(model, Eigen::Vector2d::Zero(), finely_sampled(twist), segment).poses.back().vector();
}

MappedGround hills() {
  Eigen::MatrixXd nodes(81, 81);
  for (Eigen::Index i = 0; i < 81; ++i) {
    for (Eigen::Index j = 0; j < 81; ++j) {
      nodes(i, j) = 0.5 * std::sin(0.4 * static_cast<double>(j)) * std::cos(0.3 * static_cast<double>(i));
    }
  }
  return {std::make_shared<const ElevationMap>(nodes, Eigen::Vector2d(-20.0, -20.0), 0.5), {0.3, -0.4, 0.6}};
}

/// A bent surface without the borders of cells on the way: there the bend jumps.
MappedGround wide_cell() {
  Eigen::MatrixXd nodes(4, 4);
  for (Eigen::Index i = 0; i < 4; ++i) {
    for (Eigen::Index j = 0; j < 4; ++j) {
      const double x = 30.0 * (static_cast<double>(j) - 1.5);
      const double y = 30.0 * (static_cast<double>(i) - 1.5);
      nodes(i, j) = 0.008 * x * x - 0.005 * y * y + 0.006 * x * y + 1e-4 * x * x * y + 0.1 * x;
    }
  }
  return {std::make_shared<const ElevationMap>(nodes, Eigen::Vector2d(-45.0, -45.0), 30.0), {3.0, -4.0, 0.6}};
}

MeasuredTilts rocking() {
  MeasuredTilts tilts;
  for (int i = 0; i < 500; ++i) {
    const double t = 0.01 * i;
    tilts.at.push_back({t, 0.2 * std::sin(1.5 * t), 0.15 * std::cos(2.0 * t) + 0.1});
  }
  return tilts;
}

TEST_CASE("a path on a plane is the flat path, projected") {
  const Grade plane{.rise_x = 0.25, .rise_y = -0.15};
  // Axes of the plane: the robot's at the start, whose x axis looks along yaw 0.
  const Standing at = standing_at(plane, Pose2{});
  const Eigen::Matrix3d axes = turned(at.roll, at.pitch, 0.0);
  for (const tests::SampleDrive& drive : tests::sample_drives()) {
    CAPTURE(drive.name);
    const MotionModel model(named_basis("edd-2"), {});
    const Pose2 flat =
        integrate_segment(model, Eigen::Vector2d::Zero(), finely_sampled(drive.twist), {.start = kStart, .end = kEnd})
            .poses.back();
    const Eigen::Vector3d where = axes * Eigen::Vector3d(flat.x, flat.y, 0.0);
    const Eigen::Vector3d ahead = axes * Eigen::Vector3d(std::cos(flat.theta), std::sin(flat.theta), 0.0);
    const Eigen::Vector3d end = end_of(plane, drive.twist);
    CHECK(end.x() == doctest::Approx(where.x()).epsilon(1e-5));
    CHECK(end.y() == doctest::Approx(where.y()).epsilon(1e-5));
    CHECK(std::abs(wrap_angle(end.z() - std::atan2(ahead.y(), ahead.x()))) < 1e-5);
    CHECK(standing_at(plane, Pose2::from_vector(end)).z == doctest::Approx(where.z()).epsilon(1e-4));
  }
}

TEST_CASE("paths over hills and along a measured attitude are those of rotations in space") {
  const Ground ground = hills();
  const MeasuredTilts tilts = rocking();
  const Attitude on_hills = [&](const Eigen::Vector3d& pose, double /*t*/) {
    const Standing at = standing_at(ground, Pose2::from_vector(pose));
    return Eigen::Vector2d(at.roll, at.pitch);
  };
  const Attitude measured = [&](const Eigen::Vector3d& /*pose*/, double t) {
    const Tilt tilt = tilt_between(tilts, t);
    return Eigen::Vector2d(tilt.roll, tilt.pitch);
  };
  for (const tests::SampleDrive& drive : tests::sample_drives()) {
    CAPTURE(drive.name);
    CHECK((end_of(ground, drive.twist) - path_in_space(on_hills, drive.twist, kStart, kEnd)).norm() < 3e-3);
    CHECK((end_of(tilts, drive.twist) - path_in_space(measured, drive.twist, kStart, kEnd)).norm() < 3e-3);
  }
}

TEST_CASE("level ground of any kind is no ground to rounding") {
  const MotionModel model(tests::user_basis(), {.dynamics = true});
  Eigen::VectorXd parameters(model.size());
  parameters << tests::sample_slip(model.basis(), 5), std::log(0.3), std::log(0.2), std::log(0.08), std::log(0.11);
  const InputHistory inputs = tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.05, 100);
  const Segment flat{.start = kStart, .end = kEnd};
  const auto expected = linearize_segment(model, parameters, inputs, flat);
  const MappedGround map{
      std::make_shared<const ElevationMap>(Eigen::MatrixXd::Zero(3, 3), Eigen::Vector2d(0.0, 0.0), 1.0), {}};
  for (const Ground& ground : {Ground(MeasuredTilts{}), Ground(Grade{}), Ground(map)}) {
    Segment segment = flat;
    segment.ground = std::make_shared<const Ground>(ground);
    const auto at = linearize_segment(model, parameters, inputs, segment);
    CHECK((at.predicted - expected.predicted).norm() < 1e-13);
    CHECK((at.by_parameter - expected.by_parameter).norm() < 1e-12);
  }
}

TEST_CASE("wheels turn further than a map shows where the ground is steep") {
  const auto straight = [](double /*t*/) { return BodyTwist{1.0, 0.0, 0.0}; };
  const Eigen::Vector3d end = end_of(Grade{.rise_x = 0.2, .rise_y = 0.0}, straight);
  CHECK(end.x() == doctest::Approx((kEnd - kStart) * std::cos(std::atan(0.2))));
  CHECK(end.y() == 0.0);
}

TEST_CASE("gravity turns with the heading on a plane") {
  const ActuatorStep still{.duration = 0.1, .forward = 0.0, .left = 0.0, .turn = 0.0};
  const Ground plane = Grade{.rise_x = 0.2, .rise_y = 0.0};
  const double pull = kStandardGravity * std::sin(std::atan(0.2));
  CHECK(ground_step(plane, still, {0.0, 0.0, 0.0}, 0.0).gravity.gx == doctest::Approx(-pull));
  CHECK(ground_step(plane, still, {0.0, 0.0, 1.5707963267948966}, 0.0).gravity.gy == doctest::Approx(pull));
}

TEST_CASE("the derivative by every parameter is exact on planes, on hills and along a measured attitude") {
  Eigen::VectorXd all(11);
  all << std::log(0.31), std::log(0.22), std::log(0.0827), std::log(0.1133), 0.93, 1.12, 0.21, 0.34, std::log(1.31),
      std::log(0.82), 0.0231;
  // A measured attitude has kinks at its stamps: this one has none on the way.
  const MeasuredTilts tipping{{{0.0, 0.2, -0.3}, {10.0, -0.3, 0.4}}};
  const std::vector<Ground> grounds{Grade{.rise_x = 0.2, .rise_y = -0.3}, wide_cell(), tipping};
  for (const Basis& basis : {named_basis("ipem-13"), tests::user_basis()}) {
    const MotionModel model(basis, {.dynamics = true, .clock_offset = true, .response = true});
    Eigen::VectorXd parameters(model.size());
    parameters << tests::sample_slip(basis, 21), all;
    for (std::size_t g = 0; g < grounds.size(); ++g) {
      Segment segment{.start = kStart, .end = kEnd};
      segment.ground = std::make_shared<const Ground>(grounds[g]);
      for (const tests::SampleDrive& drive : tests::sample_drives()) {
        CAPTURE(basis.name());
        CAPTURE(g);
        CAPTURE(drive.name);
        const InputHistory inputs = tests::sampled(drive.twist, 0.0, 0.05, 120);
        const auto value = [&](const Eigen::VectorXd& p) -> Eigen::VectorXd {
          return integrate_segment(model, p, inputs, segment).rows();
        };
        const auto numeric = tests::finite_difference(value, parameters, 1e-3);
        const auto at = linearize_segment(model, parameters, inputs, segment);
        CHECK(tests::jacobian_error(at.by_parameter, numeric, 0.1) < tests::kDerivativeTolerance);
        CHECK((at.predicted - value(parameters)).norm() < 1e-12);
      }
    }
  }
}

TEST_CASE("the slip rate's derivative by gravity is that of differences, powers included") {
  const std::vector<std::string> lon{"gx", "V*gx^2"}, lat{"gy*gx"}, ang{"w*gy^3", "V"};
  const Basis basis("steep", lon, lat, ang);
  const Eigen::VectorXd alpha = tests::sample_slip(basis, 3);
  const SlipState state{.v = 0.8, .omega = -0.4, .gx = 0.7, .gy = -1.1};
  const auto value = [&](const Eigen::VectorXd& g) -> Eigen::VectorXd {
    return slip_rate(basis, alpha, {.v = state.v, .omega = state.omega, .gx = g[0], .gy = g[1]});
  };
  const auto numeric = tests::finite_difference(value, Eigen::Vector2d(state.gx, state.gy), 1e-3);
  CHECK((slip_rate_by_gravity(basis, alpha, state) - numeric).norm() < 1e-9);
  CHECK(slip_rate_by_gravity(basis, alpha, {.v = 0.0, .omega = 0.0, .gx = 1.0}).isZero(0.0));
}

}  // namespace
}  // namespace slipwise
