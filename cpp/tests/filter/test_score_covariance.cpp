// SPDX-License-Identifier: Apache-2.0
// Factors of reported standard deviations: right for white, too large and slowly varying errors.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "slipwise/filter/score_covariance.hpp"

namespace slipwise {
namespace {

constexpr int kRuns = 300;
constexpr int kSegments = 300;
constexpr double kStd = 0.1;  // of the noise model, in every component

/// Errors of one unit of variance: `slow` of it with a correlation time of `seconds`, the rest white. As long they are
/// `said` to be alike.
struct ErrorModel {
  double std = kStd;
  double slow = 0.0;
  double seconds = 5.0;
  double said = 5.0;
};

struct Scatter {
  double true_variance = 0.0;      ///< of the estimated angular slip, over runs
  double reported_variance = 0.0;  ///< mean
};

/// Least squares of a linear model whose one parameter is the yaw slip per yaw rate, over segments of one second.
Scatter scatter(const ErrorModel& errors) {
  const std::vector<std::string> yaw_rate{"w"};
  const MotionModel model(Basis("one", {}, {}, yaw_rate), {});
  const Eigen::Matrix3d noise = kStd * kStd * Eigen::Matrix3d::Identity();
  const double keep = std::exp(-1.0 / errors.seconds);
  std::mt19937_64 random(18);
  std::normal_distribution<double> normal;
  Scatter sum;
  for (int run = 0; run < kRuns; ++run) {
    Eigen::VectorXd error(kSegments);
    double slow = normal(random);
    for (double& value : error) {
      value = errors.std * (std::sqrt(errors.slow) * slow + std::sqrt(1.0 - errors.slow) * normal(random));
      slow = keep * slow + std::sqrt(1.0 - keep * keep) * normal(random);
    }
    const Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(1, 1, kStd * kStd / kSegments);
    ScoreCovariance scores(model);
    for (int i = 0; i < kSegments; ++i) {
      SegmentLinearization at;
      at.predicted.setZero(3);
      at.by_parameter = Eigen::MatrixXd::Zero(3, 1);
      at.by_parameter(2, 0) = 1.0;
      const Segment segment{
          .start = double(i), .end = i + 1.0, .measured = measured_pose({0.0, 0.0, error[i] - error.mean()})};
      scores.add(at, covariance, segment, noise);
    }
    const double factor = scores.std_factors(Eigen::MatrixXd::Constant(1, 1, 1e4), covariance, errors.said)[0];
    sum.true_variance += error.mean() * error.mean() / kRuns;
    sum.reported_variance += factor * factor * covariance(0, 0) / kRuns;
  }
  return sum;
}

TEST_CASE("white errors of the noise model leave the covariance as it is") {
  const Scatter found = scatter({});
  CHECK(found.reported_variance / found.true_variance == doctest::Approx(1.0).epsilon(0.15));
}

TEST_CASE("errors twice as large as the noise model says are reported twice as large") {
  const Scatter found = scatter({.std = 2.0 * kStd});
  CHECK(found.reported_variance / found.true_variance == doctest::Approx(1.0).epsilon(0.2));
}

TEST_CASE("errors that are correlated in time teach less, and the covariance says so") {
  for (const double slow : {0.3, 1.0}) {
    CAPTURE(slow);
    const Scatter found = scatter({.slow = slow});
    CHECK(found.true_variance > 3.0 * kStd * kStd / kSegments);
    CHECK(found.reported_variance / found.true_variance == doctest::Approx(1.1).epsilon(0.25));
  }
}

TEST_CASE("errors that last longer than usual are made good for as long as is said") {
  const Scatter usual = scatter({.slow = 0.5, .seconds = 20.0});
  const Scatter told = scatter({.slow = 0.5, .seconds = 20.0, .said = 20.0});
  CHECK(usual.reported_variance / usual.true_variance < 0.75);
  CHECK(told.reported_variance / told.true_variance == doctest::Approx(1.0).epsilon(0.15));
}

SegmentLinearization yaw_segment(double jacobian) {
  SegmentLinearization at;
  at.predicted.setZero(3);
  at.by_parameter = Eigen::MatrixXd::Zero(3, 2);
  at.by_parameter(2, 1) = jacobian;
  return at;
}

TEST_CASE("channels are judged apart, and a channel without scores keeps its covariance") {
  ScoreCovariance scores(MotionModel(named_basis("edd-2"), {}));
  const Eigen::Matrix2d covariance = Eigen::Vector2d(1.0, 1e-3).asDiagonal();
  for (int i = 0; i < 100; ++i) {
    const Segment segment{
        .start = double(i), .end = i + 1.0, .measured = measured_pose({0.0, 0.0, i < 50 ? 0.2 : -0.2})};
    scores.add(yaw_segment(1.0), covariance, segment, 0.01 * Eigen::Matrix3d::Identity());
  }
  const Eigen::VectorXd factors = scores.std_factors(Eigen::Matrix2d::Identity(), covariance);
  CHECK(factors[0] == 1.0);
  CHECK(factors[1] > 2.0);
}

TEST_CASE("a parked robot says nothing of the scores, and a restart forgets them") {
  const MotionModel model(named_basis("edd-2"), {});
  ScoreCovariance scores(model);
  const Eigen::Matrix2d covariance = 0.01 * Eigen::Matrix2d::Identity();
  const Segment segment{.start = 0.0, .end = 1.0, .measured = measured_pose({0.0, 0.0, 1.0})};
  scores.add(yaw_segment(0.0), covariance, segment, 0.01 * Eigen::Matrix3d::Identity());
  CHECK(scores.std_factors(Eigen::Matrix2d::Identity(), covariance) == Eigen::Vector2d::Ones());
  scores.add(yaw_segment(1.0), covariance, segment, 0.01 * Eigen::Matrix3d::Identity());
  CHECK(scores.std_factors(Eigen::Matrix2d::Identity(), covariance)[1] > 1.0);
  scores.restart();
  CHECK(scores.std_factors(Eigen::Matrix2d::Identity(), covariance) == Eigen::Vector2d::Ones());
}

TEST_CASE("what was learned before time went back is another run, and not correlated") {
  const MotionModel model(named_basis("edd-2"), {});
  ScoreCovariance one_run(model);
  ScoreCovariance two_runs(model);
  const Eigen::Matrix2d covariance = 0.01 * Eigen::Matrix2d::Identity();
  for (int i = 0; i < 40; ++i) {
    const Segment segment{.start = double(i), .end = i + 1.0, .measured = measured_pose({0.0, 0.0, 0.2})};
    one_run.add(yaw_segment(1.0), covariance, segment, 0.01 * Eigen::Matrix3d::Identity());
    const Segment back{.start = -double(i), .end = 1.0 - i, .measured = measured_pose({0.0, 0.0, 0.2})};
    two_runs.add(yaw_segment(1.0), covariance, back, 0.01 * Eigen::Matrix3d::Identity());
  }
  const Eigen::Matrix2d prior = Eigen::Matrix2d::Identity();
  CHECK(one_run.std_factors(prior, covariance)[1] > 2.0 * two_runs.std_factors(prior, covariance)[1]);
}

TEST_CASE("a model without parameters has no factors") {
  const ScoreCovariance scores(MotionModel(Basis("none", {}, {}, {}), {}));
  CHECK(scores.std_factors(Eigen::MatrixXd(0, 0), Eigen::MatrixXd(0, 0)).size() == 0);
}

}  // namespace
}  // namespace slipwise
