// SPDX-License-Identifier: Apache-2.0
// What sensors see along a path: poses, courses of its own chords, turns; derivatives, and the noise of what was
// measured.
#include "slipwise/segment/sight.hpp"

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
#include "slipwise/sensor/sensor_motion.hpp"

namespace slipwise {
namespace {

constexpr double kStep = 1e-3;
const std::vector<std::string> kSpeed{"V"};

PositionSensor& positions_of(Segment& segment) {
  return std::get<PositionSensor>(segment.measured.front().sensor.kind);
}

Measured turn_by_gyro() { return {.sensor = {.kind = YawRateSensor{.std = 0.02}}, .z = Rows::Zero(1)}; }

Segment between_positions() {
  Segment segment{.start = 3.0131, .end = 5.0177};
  segment.measured.front().sensor.kind =
      PositionSensor{.chords = {Chord{.from = 2.1177, .offset = 0.0}, Chord{.from = 4.2093, .offset = 0.3}}};
  return segment;
}

Segment by_gyro() {
  Segment segment = between_positions();
  positions_of(segment).turn = false;
  segment.measured.front().z = Eigen::Vector2d::Zero();
  segment.measured.push_back(turn_by_gyro());
  return segment;
}

/// A pose, and beside it what a gyro says, whose stamps are late.
Segment pose_and_late_gyro() {
  Segment segment{.start = 3.0131, .end = 5.0177};
  segment.measured.push_back(turn_by_gyro());
  segment.measured.back().sensor.clock = 0.1117;
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
    return integrate_segment(model, p, inputs, segment).rows();
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
  positions_of(overlapping).chords[1].from = 2.5113;  // before the segment's start
  for (const tests::SampleDrive& drive : tests::sample_drives()) {
    CAPTURE(drive.name);
    const InputHistory inputs = tests::sampled(drive.twist, 0.0, 0.05, 200);
    for (const Segment& segment : {between_positions(), overlapping, by_gyro(), pose_and_late_gyro()}) {
      CHECK(derivative_error(model, with_slip(basis, others), segment, inputs) < 1e-5);
      CHECK(linearize_slip(model, with_slip(basis, others), inputs, segment)
                .by_parameter.isApprox(linearize_segment(model, with_slip(basis, others), inputs, segment)
                                           .by_parameter.leftCols(model.slip_size()),
                                       1e-9));
    }
  }
}

TEST_CASE("what sensors see is made of where they are at fixed moments, each by its own clock") {
  const Basis basis = named_basis("drive-5");
  const Pose2 place{0.4, -0.1, 0.0};
  const InputHistory inputs = tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.05, 200);
  const MotionModel model(basis, {});
  const Eigen::VectorXd slip = tests::sample_slip(basis, 5);
  const auto seen_at = [&](double t) -> Eigen::Vector3d {
    const Segment until{.start = 2.1177, .end = t, .measured = measured_pose({}, place)};
    return integrate_segment(model, slip, inputs, until).rows();
  };
  Segment segment = between_positions();
  segment.measured.front().sensor.place = place;
  segment.measured.push_back(turn_by_gyro());
  segment.measured.back().sensor.clock = 0.1117;
  const Rows found = integrate_segment(model, slip, inputs, segment).rows();
  const auto chord = [&](double from, double to) -> Eigen::Vector2d { return (seen_at(to) - seen_at(from)).head<2>(); };
  const Eigen::Vector2d first = seen_at(3.0131).head<2>();
  const Eigen::Vector2d last = chord(4.2093, 5.0177);
  CHECK(found.size() == 4);
  CHECK(found.head<2>().norm() == doctest::Approx(chord(3.0131, 5.0177).norm()));
  const double turn = std::atan2(last.y(), last.x()) + 0.3 - std::atan2(first.y(), first.x());
  CHECK(std::remainder(found[2] - turn, 6.283185307179586) == doctest::Approx(0.0).epsilon(1e-9));
  CHECK(found[3] == doctest::Approx((seen_at(5.0177 - 0.1117) - seen_at(3.0131 - 0.1117)).z()));
}

TEST_CASE("a side slip that is always the same does not move courses, and neither does how an antenna is turned") {
  const Basis basis("crab", kSpeed, kSpeed, {});
  const MotionModel model(basis, {});
  const InputHistory inputs = tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.05, 200);
  const Segment segment = between_positions();
  Segment turned = segment;
  turned.measured.front().sensor.place.theta = 0.7;
  const double crab = 0.2;
  const Eigen::Vector2d straight(0.0, 0.0);
  const Eigen::Vector2d sideways(std::cos(crab) - 1.0, std::sin(crab));
  const Eigen::Vector3d wanted = integrate_segment(model, straight, inputs, segment).rows();
  CHECK((integrate_segment(model, sideways, inputs, segment).rows() - wanted).norm() < 1e-9);
  CHECK((integrate_segment(model, straight, inputs, turned).rows() - wanted).norm() < 1e-9);
}

TEST_CASE("the noise of four positions is that of seeded draws, and of one error where two of them are one") {
  const InputHistory inputs = tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.05, 200);
  const MotionModel model(Basis("none", {}, {}, {}), {});
  Segment joined = between_positions();
  positions_of(joined).chords[1].from = joined.start;
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  for (const Segment& segment : {between_positions(), joined}) {
    const SegmentPath path = integrate_segment(model, Eigen::VectorXd(0), inputs, segment);
    const MotionNoise noise{.pose_std_xy = 0.01, .pose_std_yaw = 1e-3};
    const Eigen::Vector3d truth = path.rows();
    const Sight& sight = path.sights.front();
    constexpr int kDraws = 20000;
    Eigen::Matrix3d squares = 1e-6 * Eigen::Matrix3d::Identity() * kDraws;
    for (int i = 0; i < kDraws; ++i) {
      auto robot = sight.robot(path.poses);
      for (Pose2& pose : robot) {
        pose.x += 0.01 * normal(random);
        pose.y += 0.01 * normal(random);
      }
      if (sight.at[kEndChord] == sight.at[kStart]) {
        robot[kEndChord] = robot[kStart];
      }
      const View view{.robot = robot, .stamps = sight.stamps, .measured = truth};
      const Eigen::Vector3d error = see(path.measured.front().sensor, view).z - truth;
      squares += error * error.transpose();
    }
    const Eigen::Matrix3d stated = path.measurement_noise(truth, noise);
    const Eigen::Matrix3d sampled = squares / kDraws;
    CHECK((sampled - stated).norm() < 0.05 * stated.norm());
  }
}

TEST_CASE("where a gyro measures, the turn is the robot's own with the gyro's noise, and the rest is of courses") {
  const InputHistory inputs = tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.05, 200);
  const MotionModel model(Basis("none", {}, {}, {}), {});
  const Eigen::VectorXd none(0);
  const SegmentPath path = integrate_segment(model, none, inputs, by_gyro());
  const Rows found = path.rows();
  const Rows courses = integrate_segment(model, none, inputs, between_positions()).rows();
  const Rows robot = integrate_segment(model, none, inputs, {.start = 3.0131, .end = 5.0177}).rows();
  CHECK(found.head<2>().isApprox(courses.head<2>()));
  CHECK(found[2] == doctest::Approx(robot[2]));
  const MotionNoise noise{.pose_std_xy = 0.01, .pose_std_yaw = 1e-3};
  const Eigen::Matrix3d covariance = path.measurement_noise(found, noise);
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
