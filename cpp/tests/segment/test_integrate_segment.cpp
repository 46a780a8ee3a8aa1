// SPDX-License-Identifier: Apache-2.0
// Laws of integration: splitting, limits, straight lines, the mirror, and the order of Runge-Kutta.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "sample_bases.hpp"
#include "sample_drives.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

Pose2 last_pose(const Basis& basis, const Eigen::VectorXd& alpha, const InputHistory& inputs, const Segment& segment) {
  return integrate_segment(MotionModel(basis, {}), alpha, inputs, segment).poses.back();
}

InputHistory constant_drive(const BodyTwist& twist) {
  const std::vector<double> t{0.0}, v{twist.v}, vy{twist.vy}, omega{twist.omega};
  return {t, v, vy, omega};
}

TEST_CASE("splitting a segment in two changes nothing in any basis") {
  for (const Basis& basis : tests::all_bases()) {
    const Eigen::VectorXd alpha = tests::sample_slip(basis, 31);
    for (const tests::SampleDrive& drive : tests::sample_drives()) {
      CAPTURE(basis.name());
      CAPTURE(drive.name);
      const InputHistory inputs = tests::sampled(drive.twist, 0.0, 0.05, 200);
      const Pose2 whole = last_pose(basis, alpha, inputs, {.start = 1.01, .end = 4.47});
      for (const double middle : {1.05, 2.2, 2.217, 4.469}) {
        const Pose2 first = last_pose(basis, alpha, inputs, {.start = 1.01, .end = middle});
        const Pose2 second = last_pose(basis, alpha, inputs, {.start = middle, .end = 4.47});
        CHECK((compose(first, second).vector() - whole.vector()).norm() < 1e-12);
      }
    }
  }
}

TEST_CASE("without slip every basis drives the commanded circle") {
  for (const Basis& basis : tests::all_bases()) {
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(basis.size()));
    const Pose2 pose = last_pose(basis, zero, constant_drive({1.5, 0.0, 0.5}), {.start = 1.0, .end = 3.0});
    CHECK(pose.x == doctest::Approx(3.0 * std::sin(1.0)).epsilon(1e-13));
    CHECK(pose.y == doctest::Approx(3.0 * (1.0 - std::cos(1.0))).epsilon(1e-13));
    CHECK(pose.theta == doctest::Approx(1.0).epsilon(1e-13));
  }
}

TEST_CASE("a parked robot stays where it is in every basis") {
  for (const Basis& basis : tests::all_bases()) {
    const Segment on_slope{.start = 1.0, .end = 6.0, .gx = 2.0, .gy = -1.0};
    const Pose2 pose = last_pose(basis, tests::sample_slip(basis, 32), constant_drive({}), on_slope);
    CHECK(pose.vector().isZero(0.0));
  }
}

TEST_CASE("a straight segment has no yaw and no sideways motion where the basis respects the mirror") {
  const std::vector<std::string> lon{"V", "w^2"}, lat{"w", "V*w"}, ang{"w", "w*abs(w)"};
  const Basis mirrored("mirrored", lon, lat, ang);
  for (const Basis& basis : {named_basis("edd-2"), mirrored}) {
    const Pose2 pose =
        last_pose(basis, tests::sample_slip(basis, 33), constant_drive({1.2, 0.0, 0.0}), {.start = 1.0, .end = 6.0});
    CHECK(pose.theta == 0.0);
    CHECK(pose.y == 0.0);
    CHECK(pose.x > 5.0);
  }
}

TEST_CASE("left turns mirror right turns where the basis respects the mirror") {
  const std::vector<std::string> lon{"V", "V*abs(w)", "sgn(V)*w^2"}, lat{"w", "V*w", "w*abs(w)"},
      ang{"w", "V*w", "w*abs(w)"};
  const Basis basis("odd-even-9", lon, lat, ang);
  const Eigen::VectorXd alpha = tests::sample_slip(basis, 34);
  const Pose2 left = last_pose(basis, alpha, constant_drive({0.8, 0.0, 0.7}), {.start = 1.0, .end = 4.0});
  const Pose2 right = last_pose(basis, alpha, constant_drive({0.8, 0.0, -0.7}), {.start = 1.0, .end = 4.0});
  CHECK(left.x == doctest::Approx(right.x).epsilon(1e-13));
  CHECK(left.y == doctest::Approx(-right.y).epsilon(1e-13));
  CHECK(left.theta == doctest::Approx(-right.theta).epsilon(1e-13));
}

TEST_CASE("paths carry times in pose stamps, one pose more than steps, and the drive without slip") {
  const MotionModel model(named_basis("edd-2"), {.clock_offset = true});
  const InputHistory inputs = tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.05, 200);
  const auto path = integrate_segment(model, Eigen::Vector3d(0.1, -0.1, 0.13), inputs, {.start = 2.0, .end = 3.0});
  CHECK(path.times.front() == 2.0);
  CHECK(path.times.back() == doctest::Approx(3.0).epsilon(1e-12));
  CHECK(path.poses.size() == path.tangents.size() + 1);
  CHECK(path.drive.size() == path.tangents.size());
  CHECK(path.poses.front().vector().isZero(0.0));
  CHECK(path.tangents[3].x() == doctest::Approx(1.1 * path.drive[3].forward).epsilon(1e-12));
}

TEST_CASE("Runge-Kutta is Simpson's rule on a constant twist: its error is f^4 / 2880") {
  const MotionModel model(named_basis("edd-2"), {});
  const auto relative_error = [&](double turn) {
    const InputHistory inputs = constant_drive({1.0, 0.0, turn});
    const Segment second{.start = 1.0, .end = 2.0};
    const Pose2 exact = integrate_segment(model, Eigen::Vector2d::Zero(), inputs, second).poses.back();
    const Pose2 rk4 = integrate_segment(model, Eigen::Vector2d::Zero(), inputs, second, Integrator::Rk4).poses.back();
    CHECK(rk4.theta == exact.theta);
    return std::hypot(rk4.x - exact.x, rk4.y - exact.y) / std::hypot(exact.x, exact.y);
  };
  for (const double turn : {0.1, 0.2, 0.4}) {
    CAPTURE(turn);
    CHECK(relative_error(turn) == doctest::Approx(std::pow(turn, 4) / 2880.0).epsilon(0.01));
  }
}

TEST_CASE("Runge-Kutta's error falls with the fourth power of the step over all bases") {
  const auto error = [](const Basis& basis, double period) {
    const MotionModel model(basis, {});
    const Eigen::VectorXd alpha = tests::sample_slip(basis, 35);
    const auto twist = [](double) { return BodyTwist{0.9, 0.0, 0.8}; };
    const InputHistory inputs = tests::sampled(twist, 0.0, period, static_cast<std::size_t>(std::lround(6.0 / period)));
    const Segment segment{.start = 1.6, .end = 4.8};
    const Pose2 exact = integrate_segment(model, alpha, inputs, segment).poses.back();
    const Pose2 rk4 = integrate_segment(model, alpha, inputs, segment, Integrator::Rk4).poses.back();
    return std::hypot(rk4.x - exact.x, rk4.y - exact.y);
  };
  for (const Basis& basis : tests::all_bases()) {
    CAPTURE(basis.name());
    CHECK(std::log2(error(basis, 0.8) / error(basis, 0.4)) == doctest::Approx(4.0).epsilon(0.03));
  }
}

TEST_CASE("parameters that do not fit the model are refused") {
  const MotionModel model(named_basis("edd-2"), {});
  const InputHistory inputs = constant_drive({1.0, 0.0, 0.0});
  CHECK_THROWS_AS(integrate_segment(model, Eigen::Vector3d::Zero(), inputs, {.start = 0.0, .end = 1.0}),
                  std::invalid_argument);
  CHECK_THROWS_AS(linearize_segment(model, Eigen::Vector3d::Zero(), inputs, {.start = 0.0, .end = 1.0}),
                  std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
