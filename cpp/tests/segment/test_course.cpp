// SPDX-License-Identifier: Apache-2.0
// Segments between positions: courses of a path's own chords, their derivatives, and the noise of all four positions.
#include "slipwise/segment/course.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "finite_difference.hpp"
#include "sample_bases.hpp"
#include "sample_drives.hpp"
#include "slipwise/segment/integrate_segment.hpp"
#include "slipwise/segment/segment_covariance.hpp"
#include "slipwise/segment/sensor_motion.hpp"

namespace slipwise {
namespace {

constexpr double kStep = 1e-3;
const std::vector<std::string> kSpeed{"V"};

Segment between_positions() {
  Segment segment{.start = 3.0131, .end = 5.0177};
  segment.chords = {Chord{.from = 2.1177, .offset = 0.0}, Chord{.from = 4.2093, .offset = 0.3}};
  return segment;
}

Segment by_gyro() {
  Segment segment = between_positions();
  segment.gyro_std = 0.02;
  return segment;
}

Eigen::VectorXd with_slip(const Basis& basis, const Eigen::VectorXd& others) {
  Eigen::VectorXd all(static_cast<Eigen::Index>(basis.size()) + others.size());
  all << tests::sample_slip(basis, 21), others;
  return all;
}

double derivative_error(const MotionModel& model, const Eigen::VectorXd& parameters, const Segment& segment,
                        const InputHistory& inputs) {
  const auto value = [&](const Eigen::VectorXd& p) -> Eigen::VectorXd {
    return integrate_segment(model, p, inputs, segment).sensor_motion().vector();
  };
  const auto numeric = tests::finite_difference(value, parameters, kStep);
  return tests::jacobian_error(linearize_segment(model, parameters, inputs, segment).by_parameter, numeric, 0.1);
}

}  // namespace

TEST_CASE("courses have the exact derivative by slip, by the drive, by clocks and by where the antenna sits") {
  const Basis basis = named_basis("odd-even-10");
  const MotionModel model(basis, {.dynamics = true, .clock_offset = true, .response = true, .sensor_extrinsics = true});
  Eigen::VectorXd others(14);
  others << std::log(0.31), std::log(0.22), std::log(0.0827), std::log(0.1133), 0.93, 1.12, 0.21, 0.34, std::log(1.31),
      std::log(0.82), 0.0231, 0.3, -0.2, 0.0;
  Segment overlapping = between_positions();
  overlapping.chords->back().from = 2.5113;  // before the segment's start
  for (const tests::SampleDrive& drive : tests::sample_drives()) {
    CAPTURE(drive.name);
    const InputHistory inputs = tests::sampled(drive.twist, 0.0, 0.05, 200);
    for (const Segment& segment : {between_positions(), overlapping, by_gyro()}) {
      CHECK(derivative_error(model, with_slip(basis, others), segment, inputs) < 1e-5);
      CHECK(linearize_slip(model, with_slip(basis, others), inputs, segment)
                .by_parameter.isApprox(linearize_segment(model, with_slip(basis, others), inputs, segment)
                                           .by_parameter.leftCols(model.slip_size()),
                                       1e-9));
    }
  }
}

TEST_CASE("the chart of a course is made of where the antenna is at four fixed moments") {
  const Basis basis = named_basis("drive-5");
  Segment segment = between_positions();
  segment.sensor = {0.4, -0.1, 0.0};
  const InputHistory inputs = tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.05, 200);
  const MotionModel model(basis, {});
  const Eigen::VectorXd slip = tests::sample_slip(basis, 5);
  const SegmentPath path = integrate_segment(model, slip, inputs, segment);
  const auto at = [&](double t) {
    const Segment until{.start = 2.1177, .end = t, .sensor = segment.sensor};
    const Pose2 seen = integrate_segment(model, slip, inputs, until).sensor_motion();
    return Eigen::Vector2d(seen.x, seen.y);
  };
  const CoursePositions wanted{Eigen::Vector2d::Zero(), at(3.0131), at(4.2093), at(5.0177)};
  const CoursePositions found = path.course_positions();
  for (std::size_t i = 0; i < kCoursePoints; ++i) {
    CHECK((found[i] - wanted[i]).norm() < 1e-12);
  }
  const Eigen::Vector2d first = wanted[kStart];
  const Eigen::Vector2d last = wanted[kEnd] - wanted[kEndChord];
  const Pose2 motion = path.sensor_motion();
  CHECK(std::hypot(motion.x, motion.y) == doctest::Approx((wanted[kEnd] - wanted[kStart]).norm()));
  const double turn = std::atan2(last.y(), last.x()) + 0.3 - std::atan2(first.y(), first.x());
  CHECK(std::remainder(motion.theta - turn, 6.283185307179586) == doctest::Approx(0.0).epsilon(1e-9));
}

TEST_CASE("a side slip that is always the same does not move courses, and neither does how an antenna is turned") {
  const Basis basis("crab", kSpeed, kSpeed, {});
  const MotionModel model(basis, {});
  const InputHistory inputs = tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.05, 200);
  const Segment segment = between_positions();
  Segment turned = segment;
  turned.sensor.theta = 0.7;
  const double crab = 0.2;
  const Eigen::Vector2d straight(0.0, 0.0);
  const Eigen::Vector2d sideways(std::cos(crab) - 1.0, std::sin(crab));
  const Eigen::Vector3d wanted = integrate_segment(model, straight, inputs, segment).sensor_motion().vector();
  CHECK((integrate_segment(model, sideways, inputs, segment).sensor_motion().vector() - wanted).norm() < 1e-9);
  CHECK((integrate_segment(model, straight, inputs, turned).sensor_motion().vector() - wanted).norm() < 1e-9);
}

TEST_CASE("the noise of four positions is that of seeded draws, and of one error where two of them are one") {
  const InputHistory inputs = tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.05, 200);
  const MotionModel model(Basis("none", {}, {}, {}), {});
  Segment joined = between_positions();
  joined.chords->back().from = joined.start;
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  for (const Segment& segment : {between_positions(), joined}) {
    const SegmentPath path = integrate_segment(model, Eigen::VectorXd(0), inputs, segment);
    const MotionNoise noise{.pose_std_xy = 0.01, .pose_std_yaw = 1e-3};
    const Eigen::Vector3d truth = path.sensor_motion().vector();
    constexpr int kDraws = 20000;
    Eigen::Matrix3d squares = 1e-6 * Eigen::Matrix3d::Identity() * kDraws;
    for (int i = 0; i < kDraws; ++i) {
      CoursePositions points = path.course_positions();
      for (Eigen::Vector2d& point : points) {
        point += 0.01 * Eigen::Vector2d(normal(random), normal(random));
      }
      if (path.course->at[kEndChord] == path.course->at[kStart]) {
        points[kEndChord] = points[kStart];
      }
      const Eigen::Vector3d error = course_motion(points, *path.course, 0.0).vector() - truth;
      squares += error * error.transpose();
    }
    const Eigen::Matrix3d stated = pose_noise_covariance(path, path.sensor_motion(), noise);
    const Eigen::Matrix3d sampled = squares / kDraws;
    CHECK((sampled - stated).norm() < 0.05 * stated.norm());
  }
}

TEST_CASE("where a gyro measures, the turn is the robot's own with the gyro's noise, and the rest is of courses") {
  const InputHistory inputs = tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.05, 200);
  const MotionModel model(Basis("none", {}, {}, {}), {});
  const Eigen::VectorXd none(0);
  const SegmentPath path = integrate_segment(model, none, inputs, by_gyro());
  const Pose2 found = path.sensor_motion();
  const Pose2 courses = integrate_segment(model, none, inputs, between_positions()).sensor_motion();
  const Pose2 robot = integrate_segment(model, none, inputs, {.start = 3.0131, .end = 5.0177}).sensor_motion();
  CHECK(found.x == doctest::Approx(courses.x));
  CHECK(found.y == doctest::Approx(courses.y));
  CHECK(found.theta == doctest::Approx(robot.theta));
  const MotionNoise noise{.pose_std_xy = 0.01, .pose_std_yaw = 1e-3};
  const Eigen::Matrix3d covariance = pose_noise_covariance(path, found, noise);
  CHECK(covariance(2, 2) == doctest::Approx(4e-4));
  CHECK(covariance.block<2, 1>(0, 2).isZero(0.0));
  const MotionNoise turning{.psd_time = {0.0, 0.0, 1e-4}};
  CHECK(slip_covariance(path, turning)(2, 2) == doctest::Approx(1e-4 * (5.0177 - 3.0131)).epsilon(0.01));
}

TEST_CASE("slip moves courses as it moves the path") {
  const Basis basis("each", kSpeed, {}, kSpeed);
  const MotionModel model(basis, {});
  const InputHistory inputs = tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.05, 200);
  const SegmentPath path = integrate_segment(model, Eigen::Vector2d::Zero(), inputs, between_positions());
  const MotionNoise noise{.fraction = {0.01, 0.0, 0.0}};
  const Eigen::Matrix3d columns = constant_slip(path, noise);
  const auto at = linearize_segment(model, Eigen::Vector2d::Zero(), inputs, between_positions());
  double distance = 0.0;
  double wheels = 0.0;
  for (const ActuatorStep& step : path.drive) {
    distance += std::abs(step.forward);
    wheels += std::hypot(step.forward, step.left) + kTurnRadius * std::abs(step.turn);
  }
  // A fraction of all motion moves the robot about as the same fraction of its speed does, the turns' part added.
  CHECK(columns(0, 0) == doctest::Approx(0.01 * at.by_parameter(0, 0) * wheels / distance).epsilon(0.1));
  CHECK(slip_covariance(path, noise).isApprox(columns * columns.transpose(), 1e-9));
}

}  // namespace slipwise
