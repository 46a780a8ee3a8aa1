// SPDX-License-Identifier: Apache-2.0
// What sensors see along a path: poses, positions, turns; derivatives, and the noise of what was
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

constexpr double kSightStep = 1e-3;
const std::vector<std::string> kSpeed{"V"};

PositionSensor& positions_of(Segment& segment) {
  return std::get<PositionSensor>(segment.measured.front().sensor.kind);
}

Measured turns_by_gyro(Eigen::Index pieces) {
  return {.sensor = {.kind = YawRateSensor{4e-4 * RowsCovariance::Identity(pieces, pieces)}}, .z = Rows::Zero(pieces)};
}

/// A gain that does not see where all positions are moved to, nor how they are turned.
void set_gain(PositionSensor& sensor) {
  const Eigen::Index size = 2 * sensor.fitted.cols();
  Eigen::Matrix<double, Eigen::Dynamic, 3> unseen(size, 3);
  for (Eigen::Index i = 0; i < sensor.fitted.cols(); ++i) {
    unseen.middleRows<2>(2 * i) << 1.0, 0.0, -sensor.fitted(1, i), 0.0, 1.0, sensor.fitted(0, i);
  }
  Eigen::MatrixXd gain(3, size);
  for (Eigen::Index i = 0; i < gain.size(); ++i) {
    gain.reshaped()[i] = std::sin(1.7 * static_cast<double>(i) + 0.4);
  }
  sensor.gain = gain - gain * unseen * (unseen.transpose() * unseen).inverse() * unseen.transpose();
}

Segment between_positions() {
  Segment segment{.start = 2.1177, .end = 5.0177};
  PositionSensor sensor{.motion = {1.0, 0.2, 0.4}};
  sensor.at = Eigen::Vector<double, 5>(2.1177, 2.6131, 3.5093, 4.2093, 4.8113);
  sensor.weights = 1e4 * Eigen::Vector<double, 5>(1.0, 2.0, 2.0, 0.5, 1.5);  // 1 cm and less
  sensor.fitted = Positions::Zero(2, 5);
  sensor.fitted << -1.2, -0.5, 0.1, 0.9, 1.6, -0.3, 0.0, 0.2, 0.1, -0.4;
  sensor.fitted.colwise() -= centre_of(sensor.fitted, sensor.weights);
  set_gain(sensor);
  segment.measured.front().sensor.kind = sensor;
  return segment;
}

Segment by_gyro(Eigen::Index pieces = 1) {
  Segment segment = between_positions();
  positions_of(segment).turn = false;
  segment.measured.push_back(turns_by_gyro(pieces));
  return segment;
}

/// A pose, and beside it what a gyro says, whose stamps are late.
Segment pose_and_late_gyro(Eigen::Index pieces = 1) {
  Segment segment{.start = 3.0131, .end = 5.0177};
  segment.measured.push_back(turns_by_gyro(pieces));
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
  const auto numeric = tests::finite_difference(value, parameters, kSightStep);
  return tests::jacobian_error(linearize_segment(model, parameters, inputs, segment).by_parameter, numeric, 0.1);
}

}  // namespace

TEST_CASE("ways have the exact derivative by slip, by the drive, by clocks and by where the antenna sits") {
  const Basis basis = named_basis("odd-even-10");
  const MotionModel model(basis, {.dynamics = true, .clock_offset = true, .response = true, .sensor_extrinsics = true});
  Eigen::VectorXd others(14);
  others << std::log(0.31), std::log(0.22), std::log(0.0827), std::log(0.1133), 0.93, 1.12, 0.21, 0.34, std::log(1.31),
      std::log(0.82), 0.0231, 0.3, -0.2, 0.0;
  Segment late = between_positions();
  late.measured.front().sensor.clock = 0.0713;
  for (const tests::SampleDrive& drive : tests::sample_drives()) {
    CAPTURE(drive.name);
    const InputHistory inputs = tests::sampled(drive.twist, 0.0, 0.05, 200);
    for (const Segment& segment : {between_positions(), late, by_gyro(), by_gyro(4), pose_and_late_gyro(2)}) {
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
    const Segment until{.start = 1.9, .end = t, .measured = measured_pose({}, place)};
    return integrate_segment(model, slip, inputs, until).rows();
  };
  Segment segment = between_positions();
  segment.measured.front().sensor.place = place;
  segment.measured.push_back(turns_by_gyro(1));
  segment.measured.back().sensor.clock = 0.1117;
  const Rows found = integrate_segment(model, slip, inputs, segment).rows();
  const PositionSensor& sensor = positions_of(segment);
  Positions there(2, sensor.at.size());
  for (Eigen::Index i = 0; i < there.cols(); ++i) {
    there.col(i) = seen_at(sensor.at[i]).head<2>();
  }
  CHECK(found.size() == 4);
  CHECK(found.head<3>().isApprox(sensor.motion_by(there), 1e-9));
  CHECK(found[3] == doctest::Approx((seen_at(5.0177 - 0.1117) - seen_at(2.1177 - 0.1117)).z()));
}

TEST_CASE("positions tell the same motion wherever the way begins and heads, and the fitted ones that of the fit") {
  const Segment segment = between_positions();
  const PositionSensor& sensor = std::get<PositionSensor>(segment.measured.front().sensor.kind);
  CHECK(sensor.motion_by(sensor.fitted).isApprox(sensor.motion, 1e-12));
  Positions other = sensor.fitted;
  other(0, 2) += 0.1;
  other(1, 4) -= 0.2;
  for (const double turn : {0.3, 2.9, -1.8}) {
    Positions moved = rotation(turn) * other;
    moved.colwise() += Eigen::Vector2d(5.0, -7.0);
    CHECK(sensor.motion_by(moved).isApprox(sensor.motion_by(other), 1e-9));
  }
}

TEST_CASE("a side slip that is always the same does not move ways, and neither does how an antenna is turned") {
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

TEST_CASE("the noise of means of positions is that of seeded draws") {
  const Segment segment = between_positions();
  PositionSensor sensor = std::get<PositionSensor>(segment.measured.front().sensor.kind);
  const MotionNoise noise{.pose_std_xy = 0.01, .pose_std_yaw = 1e-3};
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  constexpr int kDraws = 20000;
  Eigen::Matrix3d squares =
      Eigen::Vector3d(1e-6, 1e-6, 1e-8).asDiagonal();  // a tenth of one position's, of a heading's
  squares *= kDraws;
  for (int i = 0; i < kDraws; ++i) {
    Positions drawn = sensor.fitted;
    for (Eigen::Index k = 0; k < drawn.cols(); ++k) {
      drawn.col(k) += 1.0 / std::sqrt(sensor.weights[k]) * Eigen::Vector2d(normal(random), normal(random));
    }
    const Eigen::Vector3d error = sensor.motion_by(drawn) - sensor.motion;
    squares += error * error.transpose();
  }
  const Eigen::Matrix3d stated = sensor.noise({}, noise);
  CHECK((squares / kDraws - stated).norm() < 0.05 * stated.norm());
}

TEST_CASE("where a gyro measures, the turn is the robot's own with the gyro's noise, and the rest is of positions") {
  const InputHistory inputs = tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.05, 200);
  const MotionModel model(Basis("none", {}, {}, {}), {});
  const Eigen::VectorXd none(0);
  const SegmentPath path = integrate_segment(model, none, inputs, by_gyro());
  const Rows found = path.rows();
  const Rows positions = integrate_segment(model, none, inputs, between_positions()).rows();
  const Rows robot = integrate_segment(model, none, inputs, {.start = 2.1177, .end = 5.0177}).rows();
  CHECK(found.head<3>().isApprox(positions));
  CHECK(found[3] == doctest::Approx(robot[2]));
  const MotionNoise noise{.pose_std_xy = 0.01, .pose_std_yaw = 1e-3};
  const Eigen::Matrix4d covariance = path.measurement_noise(found, noise);
  CHECK(covariance(3, 3) == doctest::Approx(4e-4));
  CHECK(covariance.block<3, 1>(0, 3).isZero(0.0));
  CHECK(chart_of(path.directions(), found).z() == found[3]);
  const MotionNoise turning{.psd_time = {0.0, 0.0, 1e-4}};
  CHECK(slip_covariance(path, turning)(3, 3) == doctest::Approx(1e-4 * (5.0177 - 2.1177)).epsilon(0.01));
}

TEST_CASE("turns of a gyro are those of equal pieces, whose sum is the chart's") {
  const InputHistory inputs = tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.05, 200);
  const MotionModel model(Basis("none", {}, {}, {}), {});
  const Eigen::VectorXd none(0);
  const Segment pieces = by_gyro(4);
  const SegmentPath path = integrate_segment(model, none, inputs, pieces);
  const Rows found = path.rows();
  const SegmentPath whole = integrate_segment(model, none, inputs, by_gyro());
  REQUIRE(found.size() == 7);
  const double quarter = 0.25 * (pieces.end - pieces.start);
  const Segment second{.start = pieces.start + quarter, .end = pieces.start + 2.0 * quarter};
  CHECK(found[4] == doctest::Approx(integrate_segment(model, none, inputs, second).rows()[2]));
  CHECK(chart_of(path.directions(), found).isApprox(chart_of(whole.directions(), whole.rows())));
  const MotionNoise noise{.psd_time = {0.0, 0.0, 1e-4}, .pose_std_xy = 0.01, .pose_std_yaw = 1e-3};
  const RowsCovariance slip = slip_covariance(path, noise);
  CHECK(slip.bottomRightCorner<4, 4>().isApprox(1e-4 * quarter * Eigen::Matrix4d::Identity(), 0.05));
  const RowsCovariance constant = slip_covariance(path, MotionNoise{.fraction = {0.0, 0.0, 0.1}});
  CHECK(constant(3, 4) == 0.0);  // the same fraction in each piece, another in the next
  CHECK(constant(3, 3) > 0.0);
  CHECK(chart_covariance(path.directions(), slip + path.measurement_noise(found, noise))(2, 2) ==
        doctest::Approx(4e-4 * 4.0 + 1e-4 * 4.0 * quarter).epsilon(0.01));
}

TEST_CASE("slip moves ways as it moves the path") {
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
