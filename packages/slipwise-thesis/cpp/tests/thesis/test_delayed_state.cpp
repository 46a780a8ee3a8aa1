// SPDX-License-Identifier: Apache-2.0
// The delayed-state filter: equality with a batch solution over shared poses, late poses, gates and restarts.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <vector>

#include "finite_difference.hpp"
#include "simulated_drive.hpp"
#include "slipwise/linear/cholesky.hpp"
#include "slipwise/thesis/delayed_state.hpp"

namespace slipwise {
namespace {

/// Only forward and sideways slip in proportion to V while driving straight ahead: all poses are linear in everything
/// but the heading, which the noise leaves alone.
MotionModel linear_model() {
  const std::vector<std::string> lon{"V"}, lat{"V"}, none;
  return {Basis("linear", lon, lat, none), {}};
}

InputHistory varying_speed() {
  const std::vector<double> t{0.0, 2.0, 5.0, 7.5, 9.0}, v{1.0, 2.0, 0.5, 1.5, 0.7}, zero(5, 0.0);
  return {t, v, zero, zero};
}

const MotionNoise kShared{.psd_time = {1e-3, 2e-3, 0.0}, .pose_std_xy = 0.1, .pose_std_yaw = 1e-9};
constexpr std::array<double, 7> kStamps{0.0, 1.5, 3.0, 4.5, 6.0, 8.0, 10.0};

EstimatorSettings settings_of(const MotionNoise& noise) {
  EstimatorSettings settings;
  settings.noise = noise;
  settings.iekf = {.huber = 1e9, .gate = 1e18};
  return settings;
}

/// Measured positions, the first at the origin.
std::vector<Pose2> measured_poses(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Pose2> poses{{}};
  for (std::size_t i = 1; i < kStamps.size(); ++i) {
    const Eigen::Vector3d draw = tests::normal3(random);
    poses.push_back({1.1 * kStamps[i] + 0.1 * draw.x(), 0.05 * kStamps[i] + 0.1 * draw.y(), 0.0});
  }
  return poses;
}

/// Brute force: one linear Gaussian system over [alpha; x_0 ... x_n] of one axis, solved at once.
Estimate batch_axis(const Eigen::VectorXd& z, const Eigen::VectorXd& driven, double nominal, double psd, double prior) {
  const Eigen::Index n = z.size();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n + 1, n + 1);
  Eigen::VectorXd vector = Eigen::VectorXd::Zero(n + 1);
  const auto add = [&](const Eigen::VectorXd& row, double value, double variance) {
    information += row * row.transpose() / variance;
    vector += row * value / variance;
  };
  add(Eigen::VectorXd::Unit(n + 1, 0), 0.0, prior * prior);
  for (Eigen::Index i = 0; i < n; ++i) {
    add(Eigen::VectorXd::Unit(n + 1, i + 1), z[i], kShared.pose_std_xy * kShared.pose_std_xy);
    if (i > 0) {
      Eigen::VectorXd row = Eigen::VectorXd::Unit(n + 1, i + 1) - Eigen::VectorXd::Unit(n + 1, i);
      row[0] = -driven[i - 1];  // x_i - x_{i-1} - alpha d = nominal d + noise
      const double duration = kStamps[static_cast<std::size_t>(i)] - kStamps[static_cast<std::size_t>(i) - 1];
      add(row, nominal * driven[i - 1], psd * duration);
    }
  }
  const Cholesky factor(information);
  return {factor.solve(vector), factor.inverse()};
}

TEST_CASE("with shared poses the filter is the batch solution of the whole drive") {
  const MotionModel model = linear_model();
  const InputHistory inputs = varying_speed();
  const auto poses = measured_poses(91);
  const Estimate prior{Eigen::VectorXd::Zero(2), 0.04 * Eigen::MatrixXd::Identity(2, 2)};
  DelayedState filter(model, prior, settings_of(kShared));
  const auto n = static_cast<Eigen::Index>(poses.size());
  Eigen::VectorXd x(n), y(n), driven(n - 1);
  for (Eigen::Index i = 0; i < n; ++i) {
    x[i] = poses[static_cast<std::size_t>(i)].x;
    y[i] = poses[static_cast<std::size_t>(i)].y;
  }
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Segment segment{
        .start = kStamps[i - 1], .end = kStamps[i], .measured = measured_pose(between(poses[i - 1], poses[i]))};
    driven[static_cast<Eigen::Index>(i) - 1] =
        integrate_segment(model, Eigen::Vector2d::Zero(), inputs, segment).poses.back().x;
    filter.learn(inputs, segment);
  }
  const Estimate lon = batch_axis(x, driven, 1.0, kShared.psd_time[0], 0.2);
  const Estimate lat = batch_axis(y, driven, 0.0, kShared.psd_time[1], 0.2);
  const Estimate got = filter.estimate();
  CHECK(got.mean[0] == doctest::Approx(lon.mean[0]).epsilon(1e-8));
  CHECK(got.mean[1] == doctest::Approx(lat.mean[0]).epsilon(1e-8));
  CHECK(got.covariance(0, 0) == doctest::Approx(lon.covariance(0, 0)).epsilon(1e-8));
  CHECK(got.covariance(1, 1) == doctest::Approx(lat.covariance(0, 0)).epsilon(1e-8));
  CHECK(filter.pose().x == doctest::Approx(lon.mean[n]).epsilon(1e-8));
  CHECK(filter.joint().covariance(2, 2) == doctest::Approx(lon.covariance(n, n)).epsilon(1e-8));
  CHECK(filter.joint().covariance(0, 2) == doctest::Approx(lon.covariance(0, n)).epsilon(1e-8));
}

TEST_CASE("a pose that arrives late tells as much as one in time") {
  const MotionModel model = linear_model();
  const InputHistory inputs = varying_speed();
  const Estimate prior{Eigen::VectorXd::Zero(2), 0.04 * Eigen::MatrixXd::Identity(2, 2)};
  DelayedState in_time(model, prior, settings_of(kShared));
  in_time.start(0.0, {});
  DelayedState late = in_time;
  const Pose2 observed{3.4, 0.3, 0.0};
  in_time.advance(inputs, {.end = 3.0});
  in_time.correct(observed);
  in_time.advance(inputs, {.end = 3.4});
  late.advance(inputs, {.end = 3.0});
  late.clone();
  late.advance(inputs, {.end = 3.4});
  late.correct_delayed(observed);
  CHECK((late.joint().mean.head(5) - in_time.joint().mean.head(5)).norm() < 1e-12);
  const auto known = in_time.joint().covariance.topLeftCorner(5, 5);
  CHECK((late.joint().covariance.topLeftCorner(5, 5) - known).norm() < 1e-12);
}

TEST_CASE("the Jacobian of the pose prediction by parameters and start is the derivative") {
  const MotionModel model(named_basis("odd-even-10"), {});
  const InputHistory inputs =
      tests::simulate_drive(model, Eigen::VectorXd::Zero(10), {.seed = 92, .windows = 2}).inputs;
  // Without noise the covariance after advance() is F P F^T: with P = I, the cross-covariance is F itself.
  const MotionNoise exact{.pose_std_xy = 1.0, .pose_std_yaw = 1.0};
  DelayedState filter(model, {Eigen::VectorXd::Constant(10, 0.05), Eigen::MatrixXd::Identity(10, 10)},
                      settings_of(exact));
  const Pose2 start{3.0, -2.0, 0.7};
  filter.start(0.5, start);
  filter.clone();
  filter.advance(inputs, {.end = 4.0});
  Eigen::VectorXd point(13);
  point << Eigen::VectorXd::Constant(10, 0.05), start.vector();
  const auto predict = [&](const Eigen::VectorXd& s) -> Eigen::VectorXd {
    const SegmentPath path = integrate_segment(model, s.head(10), inputs, {.start = 0.5, .end = 4.0});
    return compose(Pose2::from_vector(s.tail<3>()), path.poses.back()).vector();
  };
  Eigen::MatrixXd f(3, 13);
  f << filter.joint().covariance.block(10, 0, 3, 10), filter.joint().covariance.block(10, 13, 3, 3);
  CHECK(tests::jacobian_error(f, tests::finite_difference(predict, point, 0.02)) < tests::kDerivativeTolerance);
}

TEST_CASE("a segment beyond the gate teaches nothing, and the next one begins again from its end") {
  const MotionModel model(named_basis("edd-2"), {});
  const MotionNoise noise{.psd_time = {1e-4, 1e-4, 1e-4}, .pose_std_xy = 0.01, .pose_std_yaw = 0.005};
  auto drive = tests::simulate_drive(model, Eigen::Vector2d(-0.05, -0.1), {.seed = 93, .windows = 20, .noise = noise});
  drive.segments[10].measured.front().z[0] += 50.0;
  EstimatorSettings settings;
  settings.noise = noise;
  DelayedState filter(model, {Eigen::VectorXd::Zero(2), 0.01 * Eigen::MatrixXd::Identity(2, 2)}, settings);
  for (std::size_t i = 0; i < drive.segments.size(); ++i) {
    const Estimate before = filter.estimate();
    const IekfUpdate update = filter.learn(drive.inputs, drive.segments[i]);
    CHECK((update.status == Status::Rejected) == (i == 10));
    if (i == 10) {
      CHECK(filter.estimate().mean == before.mean);
      CHECK(filter.estimate().covariance == before.covariance);
    }
  }
  CHECK((filter.estimate().mean - Eigen::Vector2d(-0.05, -0.1)).norm() < 0.02);
}

TEST_CASE("a filter that was not started, or is to go back, says so") {
  DelayedState filter(linear_model(), {Eigen::VectorXd::Zero(2), Eigen::MatrixXd::Identity(2, 2)}, {});
  CHECK_THROWS_AS(filter.advance(varying_speed(), {.end = 1.0}), std::invalid_argument);
  filter.start(2.0, {});
  CHECK_THROWS_AS(filter.advance(varying_speed(), {.end = 1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
