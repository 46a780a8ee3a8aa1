// SPDX-License-Identifier: Apache-2.0
// A prediction over several surfaces slips on each as it does there, and knows what it does not know.
#include "slipwise/disturbance/ahead_prediction.hpp"

#include <doctest/doctest.h>

#include <vector>

namespace slipwise {
namespace {

const MotionModel kModel(named_basis("edd-2"), {});
const SurfaceMoments kFirm{Eigen::Vector2d(0.0, -0.1), 1e-6 * Eigen::Matrix2d::Identity()};
const SurfaceMoments kLoose{Eigen::Vector2d(0.0, -0.5), 1e-6 * Eigen::Matrix2d::Identity()};

DrivenSegment turning(double seconds) {
  return {.inputs = InputHistory({-1.0}, {{.v = 1.0, .vy = 0.0, .omega = 0.5}}),
          .segment = {.start = 0.0, .end = seconds}};
}

MotionPosterior posterior() {
  return {kModel,
          {Eigen::VectorXd::Zero(2), Eigen::MatrixXd::Identity(2, 2)},
          Eigen::VectorXd::Ones(2),
          {},
          Eigen::Vector3d::Ones()};
}

ExpectedPose predicted(const std::vector<double>& edges, const Eigen::MatrixXd& odds, double seconds) {
  return predict_ahead({}, posterior(), {}, turning(seconds), mix_ahead(edges, odds, std::vector{kFirm, kLoose}));
}

TEST_CASE("a robot turns on each surface by what it loses there") {
  const ExpectedPose over = predicted({2.0}, Eigen::Matrix2d::Identity(), 4.0);
  CHECK(over.pose.z() == doctest::Approx(0.5 * (2.0 * 0.9 + 2.0 * 0.5)).epsilon(1e-3));
  const ExpectedPose never = predicted({}, Eigen::RowVector2d(1.0, 0.0), 4.0);
  CHECK(never.pose.z() == doctest::Approx(0.5 * 4.0 * 0.9).epsilon(1e-9));
}

TEST_CASE("without an edge it is the prediction of the posterior on that surface") {
  MotionPosterior on = posterior();
  on.estimate = {kLoose.slip, kLoose.covariance};
  const DisturbanceFilter still;
  const ExpectedPose plain = still.predict(on, {}, turning(3.0));
  const ExpectedPose ahead = predicted({}, Eigen::RowVector2d(0.0, 1.0), 3.0);
  CHECK(plain.pose.isApprox(ahead.pose, 1e-9));
  CHECK(plain.covariance.isApprox(ahead.covariance, 1e-5));
}

TEST_CASE("where it is open which surface comes, the covariance has the distance between them") {
  const Eigen::MatrixXd open = (Eigen::Matrix2d() << 1.0, 0.0, 0.5, 0.5).finished();
  const ExpectedPose expected = predicted({2.0}, open, 4.0);
  const double apart = 0.5 * 2.0 * 0.4;  // [rad] between both, over two seconds
  CHECK(expected.covariance(2, 2) == doctest::Approx(apart * apart / 4.0).epsilon(0.01));
  CHECK(predicted({2.0}, open, 1.0).covariance(2, 2) < 1e-5);
}

TEST_CASE("the derivative is that of the parameters with the edge that they move") {
  const SlipAhead ahead{.edges = {1.04}, .changes = {Eigen::Vector2d(0.0, -0.4)}};
  const auto at = linearize_ahead(kModel, kFirm.slip, turning(3.0), ahead);
  // Slip ahead by da moves the edge earlier: t = 1.04 / (1 + a), and it is turned 0.4 * 0.5 rad/s less from then on.
  CHECK(at.by_parameter(2, 1) == doctest::Approx(0.5 * 3.0).epsilon(1e-4));
  CHECK(at.by_parameter(2, 0) == doctest::Approx(-0.4 * 0.5 * 1.04).epsilon(0.02));
}

TEST_CASE("slip of other terms is refused") {
  const SurfaceMoments other{Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity()};
  const MixedAhead mixed = mix_ahead({}, Eigen::MatrixXd::Ones(1, 1), std::vector{other});
  CHECK_THROWS_AS(predict_ahead({}, posterior(), {}, turning(1.0), mixed), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
