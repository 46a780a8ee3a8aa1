// SPDX-License-Identifier: Apache-2.0
// The motion of a sensor that a robot carries: its laws, its derivatives, and what it does to slip noise.
#include "slipwise/sensor/sensor_motion.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <array>

#include "finite_difference.hpp"
#include "sample_bases.hpp"
#include "sample_drives.hpp"
#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise {
namespace {

constexpr std::array<Pose2, 4> kMotions{{{0.0, 0.0, 0.0}, {1.2, -0.3, 0.7}, {0.0, 0.0, 7.5}, {-2.0, 0.4, -1e-9}}};
constexpr std::array<Pose2, 3> kMounts{{{1.5, 0.0, 0.0}, {-0.4, 0.3, 0.2}, {0.0, 0.0, 3.0}}};

TEST_CASE("a sensor at base_link moves as the robot does") {
  for (const Pose2& robot : kMotions) {
    CHECK((sensor_motion(robot, {}).vector() - robot.vector()).norm() < 1e-15);
  }
}

TEST_CASE("a sensor ahead of the axle moves sideways when the robot turns on the spot, and keeps whole turns") {
  const Pose2 motion = sensor_motion({0.0, 0.0, 0.1}, {1.5, 0.0, 0.0});
  CHECK(motion.x == doctest::Approx(1.5 * (std::cos(0.1) - 1.0)));
  CHECK(motion.y == doctest::Approx(1.5 * std::sin(0.1)));
  CHECK(sensor_motion({0.0, 0.0, 7.5}, {1.5, 0.2, 0.3}).theta == doctest::Approx(7.5));
}

TEST_CASE("a sensor turned to the left sees the robot drive to its right") {
  const Pose2 motion = sensor_motion({1.0, 0.0, 0.0}, {0.0, 0.0, 0.1});
  CHECK(motion.y == doctest::Approx(-std::sin(0.1)));
}

TEST_CASE("the robot's motion that a sensor tells is the one that moved the sensor so") {
  for (const Pose2& robot : kMotions) {
    for (const Pose2& sensor_extrinsics : kMounts) {
      SegmentPath path;
      path.poses = {Pose2{}, robot};
      path.measured = measured_pose({}, sensor_extrinsics);
      path.sights = sights_until(1, {.start = 0.0, .end = 1.0});
      CHECK((path.robot_motion(Pose2::from_vector(path.rows())).vector() - robot.vector()).norm() < 1e-12);
    }
  }
}

TEST_CASE("the derivatives of a sensor's motion are exact") {
  for (const Pose2& robot : kMotions) {
    for (const Pose2& sensor_extrinsics : kMounts) {
      const auto by_robot = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
        return sensor_motion(Pose2::from_vector(at), sensor_extrinsics).vector();
      };
      const auto by_mount = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
        return sensor_motion(robot, Pose2::from_vector(at)).vector();
      };
      CHECK(tests::jacobian_error(sensor_by_robot(robot, sensor_extrinsics),
                                  tests::finite_difference(by_robot, robot.vector(), 1e-3),
                                  0.1) < tests::kDerivativeTolerance);
      CHECK(tests::jacobian_error(sensor_by_extrinsics(robot, sensor_extrinsics),
                                  tests::finite_difference(by_mount, sensor_extrinsics.vector(), 1e-3),
                                  0.1) < tests::kDerivativeTolerance);
    }
  }
}

TEST_CASE("slip noise is the robot's: a sensor ahead of the axle turns yaw noise into sideways noise") {
  const MotionModel model(Basis("none", {}, {}, {}), {});
  const InputHistory inputs = tests::sampled([](double) { return BodyTwist{0.0, 0.0, 1.0}; }, 0.0, 0.05, 100);
  Segment segment{.start = 1.0, .end = 1.5};
  const MotionNoise noise{.psd_time = {0.0, 0.0, 1e-3}};
  const Eigen::Matrix3d robot = slip_covariance(integrate_segment(model, Eigen::VectorXd(0), inputs, segment), noise);
  segment.measured.front().sensor.place = {2.0, 0.0, 0.0};
  const Eigen::Matrix3d sensor = slip_covariance(integrate_segment(model, Eigen::VectorXd(0), inputs, segment), noise);
  CHECK(robot(1, 1) == doctest::Approx(0.0));
  CHECK(sensor(2, 2) == doctest::Approx(robot(2, 2)));
  CHECK(sensor(0, 0) + sensor(1, 1) == doctest::Approx(4.0 * robot(2, 2)));
}

}  // namespace
}  // namespace slipwise
