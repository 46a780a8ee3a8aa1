// SPDX-License-Identifier: Apache-2.0
// Learning segment by segment: the prior follows the speeds, the noise follows the residuals.
#include <doctest/doctest.h>

#include <cmath>

#include "sample_bases.hpp"
#include "simulated_drive.hpp"
#include "slipwise/filter/causal_filter.hpp"

namespace slipwise {
namespace {

const ReferenceSpeeds kSpeeds{.v = 1.5, .omega = 0.8};
const MotionNoise kTrueNoise{.psd_time = {1e-4, 1e-4, 1e-4}, .pose_std_xy = 0.005, .pose_std_yaw = 0.002};

TEST_CASE("the noise factor finds noise that is not what the shape says") {
  const MotionModel model(named_basis("edd-2"), {});
  CausalFilterSettings settings;
  settings.noise.shape = kTrueNoise;
  MotionNoise real = settings.noise.shape;
  for (double& psd : real.psd_time) {
    psd *= 4.0;
  }
  real.pose_std_xy *= 2.0;
  real.pose_std_yaw *= 2.0;
  const Eigen::VectorXd truth = Eigen::Vector2d(-0.05, -0.3);
  const auto drive = tests::simulate_drive(model, truth, {.seed = 71, .windows = 400, .window = 1.0, .noise = real});
  CausalFilter filter(model, settings);
  Eigen::Vector3d mean_scale = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < drive.segments.size(); ++i) {
    filter.learn(drive.inputs, drive.segments[i], kSpeeds);
    if (i >= 100) {
      mean_scale += filter.noise_scale() / 300.0;
    }
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    CAPTURE(i);
    CHECK(mean_scale[i] == doctest::Approx(4.0).epsilon(0.2));
  }
}

TEST_CASE("the noise stays as given when it is not to be learned") {
  CausalFilterSettings settings;
  settings.noise.adapt = false;
  const MotionModel model(named_basis("edd-2"), {});
  const auto drive = tests::simulate_drive(model, Eigen::Vector2d(0.1, 0.1), {.seed = 72, .windows = 5});
  CausalFilter filter(model, settings);
  for (const Segment& segment : drive.segments) {
    filter.learn(drive.inputs, segment, kSpeeds);
  }
  CHECK(filter.noise_scale() == Eigen::Vector3d::Ones());
}

TEST_CASE("a prior that grows with the speeds gives the answer of knowing the speeds from the start") {
  const MotionModel model(named_basis("odd-even-10"), {});
  const Eigen::VectorXd truth = tests::sample_slip(model.basis(), 73, 0.05);
  const MotionNoise noise{.psd_time = {1e-4, 1e-4, 1e-4}, .pose_std_xy = 0.01, .pose_std_yaw = 0.004};
  const auto drive = tests::simulate_drive(model, truth, {.seed = 74, .windows = 40, .noise = noise});
  CausalFilterSettings settings;
  settings.noise.shape = noise;
  settings.noise.adapt = false;
  CausalFilter growing(model, settings);
  CausalFilter knowing(model, settings);
  for (std::size_t i = 0; i < drive.segments.size(); ++i) {
    growing.learn(drive.inputs, drive.segments[i], i < 3 ? ReferenceSpeeds{.v = 0.5, .omega = 0.3} : kSpeeds);
    knowing.learn(drive.inputs, drive.segments[i], kSpeeds);
  }
  const Eigen::VectorXd sigma = knowing.estimate().covariance.diagonal().cwiseSqrt();
  CHECK(growing.prior_std().isApprox(knowing.prior_std()));
  CHECK(((growing.estimate().mean - knowing.estimate().mean).cwiseQuotient(sigma)).cwiseAbs().maxCoeff() < 0.3);
  CHECK(growing.estimate().covariance.isApprox(knowing.estimate().covariance, 0.05));
}

/// The filter after a drive with `kTrueNoise`, given a shape whose variances are `factor` times as large.
CausalFilter learned_under(double factor, std::size_t windows) {
  const MotionModel model(named_basis("edd-2"), {});
  CausalFilterSettings settings;
  settings.noise.shape = kTrueNoise;
  for (double& psd : settings.noise.shape.psd_time) {
    psd *= factor;
  }
  settings.noise.shape.pose_std_xy *= std::sqrt(factor);
  settings.noise.shape.pose_std_yaw *= std::sqrt(factor);
  const auto drive = tests::simulate_drive(model, Eigen::Vector2d(-0.05, -0.3),
                                           {.seed = 79, .windows = windows, .window = 2.0, .noise = kTrueNoise});
  CausalFilter filter(model, settings);
  for (const Segment& segment : drive.segments) {
    filter.learn(drive.inputs, segment, kSpeeds);
  }
  return filter;
}

TEST_CASE("a first guess of the noise is forgotten once the first segments are learned again") {
  const Eigen::VectorXd commanded = learned_under(1.0, 68).estimate().covariance.diagonal();
  const Eigen::VectorXd guessed = learned_under(30.0, 68).estimate().covariance.diagonal();
  const Eigen::VectorXd just_before = learned_under(30.0, 16).estimate().covariance.diagonal();
  const Eigen::VectorXd anew = learned_under(30.0, 17).estimate().covariance.diagonal();
  for (Eigen::Index i = 0; i < 2; ++i) {
    CAPTURE(i);
    CHECK(guessed[i] / commanded[i] == doctest::Approx(1.0).epsilon(0.5));
    CHECK(anew[i] < 0.7 * just_before[i]);
  }
}

TEST_CASE("what is fitted again after a change goes on from the noise that was known") {
  CausalFilter filter = learned_under(30.0, 68);
  const double known = filter.noise_scale().maxCoeff();
  CHECK(known < 0.2);
  filter.take(ForgetSlip{0.5});
  const auto later = tests::simulate_drive(filter.model(), Eigen::Vector2d(-0.05, -0.3),
                                           {.seed = 83, .windows = 20, .window = 2.0, .noise = kTrueNoise});
  for (const Segment& segment : later.segments) {
    filter.learn(later.inputs, segment, kSpeeds);
    CHECK(filter.noise_scale().maxCoeff() < 1.5 * known);
  }
}

TEST_CASE("slices of a refit change nothing but when the work is done") {
  const MotionModel model(named_basis("edd-2"), {});
  const auto drive = tests::simulate_drive(model, Eigen::Vector2d(-0.05, -0.3),
                                           {.seed = 82, .windows = 140, .window = 1.0, .noise = kTrueNoise});
  CausalFilter at_once(model, {});
  CausalFilter sliced(model, {});
  int slices = 0;
  for (std::size_t i = 0; i < drive.segments.size(); ++i) {
    at_once.learn(drive.inputs, drive.segments[i], kSpeeds);
    sliced.learn(drive.inputs, drive.segments[i], kSpeeds);
    for (std::size_t k = 0; k < 5 * (i % 7); ++k) {
      slices += sliced.refit_slice() ? 1 : 0;
    }
    CHECK(at_once.estimate().mean == sliced.estimate().mean);
    CHECK(at_once.reported().covariance == sliced.reported().covariance);
    CHECK(at_once.noise_scale() == sliced.noise_scale());
  }
  CHECK(slices > 100);
}

/// Mean squares of errors over standard deviations, of V's and w's fraction: of the filter's, and of those it reports.
struct SquaredSigmas {
  Eigen::Vector2d plain = Eigen::Vector2d::Zero();
  Eigen::Vector2d reported = Eigen::Vector2d::Zero();
};

/// Over drives whose noise is white and of one size, given as a fraction of the motion and ten times too large.
SquaredSigmas squared_sigmas(bool adapt, int drives) {
  const MotionModel model(named_basis("edd-2"), {});
  SquaredSigmas mean;
  for (int i = 0; i < drives; ++i) {
    const Eigen::Vector2d truth(-0.05, -0.3);
    const auto seed = 300 + static_cast<std::uint64_t>(i);
    const auto drive = tests::simulate_drive(
        model, truth, {.seed = seed, .windows = 128, .window = 2.0, .noise = kTrueNoise, .shared_poses = false});
    CausalFilterSettings settings;
    settings.noise.adapt = adapt;
    if (!adapt) {
      settings.noise.shape = kTrueNoise;
      settings.branches.follow = false;  // of branches, those that prove nothing are not reported
    }
    CausalFilter filter(model, settings);
    for (const Segment& segment : drive.segments) {
      filter.learn(drive.inputs, segment, kSpeeds);
    }
    const auto squares = [&](const Estimate& found) -> Eigen::Vector2d {
      return (found.mean - truth).cwiseAbs2().cwiseQuotient(found.covariance.diagonal()) / drives;
    };
    mean.plain += squares(filter.estimate());
    mean.reported += squares(filter.reported());
  }
  return mean;
}

TEST_CASE("standard deviations reported are true though noise is not of the shape commanded") {
  const SquaredSigmas mean = squared_sigmas(true, 150);
  CHECK(mean.plain.maxCoeff() < 0.75);  // too cautious
  for (const double square : mean.reported) {
    CHECK(square == doctest::Approx(1.0).epsilon(0.25));
  }
}

TEST_CASE("noise that is known is not judged by residuals") {
  const SquaredSigmas mean = squared_sigmas(false, 5);
  CHECK(mean.plain == mean.reported);
}

TEST_CASE("what is learned again after a change of terrain is the new terrain") {
  const MotionModel model(named_basis("edd-2"), {});
  CausalFilterSettings settings;
  settings.noise.shape = kTrueNoise;
  CausalFilter filter(model, settings);
  for (const double slip : {-0.3, -0.6}) {
    const auto drive = tests::simulate_drive(model, Eigen::Vector2d(-0.05, slip),
                                             {.seed = 80, .windows = 32, .window = 2.0, .noise = kTrueNoise});
    for (const Segment& segment : drive.segments) {
      filter.learn(drive.inputs, segment, kSpeeds);
    }
    CHECK(std::abs(filter.estimate().mean[1] - slip) < 3.0 * std::sqrt(filter.estimate().covariance(1, 1)));
    filter.take(ForgetSlip{1.0});
  }
}

TEST_CASE("forgetting gives slip its prior variance back in part, and nothing to lag and delay") {
  const MotionModel model(named_basis("edd-2"), {.dynamics = true});
  const auto drive = tests::simulate_drive(model, (Eigen::VectorXd(6) << -0.1, -0.3, -1.2, -1.2, -2.3, -2.3).finished(),
                                           {.seed = 75, .windows = 30});
  CausalFilter filter(model, {});
  for (const Segment& segment : drive.segments) {
    filter.learn(drive.inputs, segment, kSpeeds);
  }
  const Estimate before = filter.estimate();
  filter.take(ForgetSlip{0.25});
  const Eigen::VectorXd variance = filter.estimate().covariance.diagonal();
  const Eigen::VectorXd prior = filter.prior_std().cwiseAbs2();
  CHECK(filter.estimate().mean == before.mean);
  CHECK(variance.head(2).isApprox(0.75 * before.covariance.diagonal().head(2) + 0.25 * prior.head(2)));
  CHECK(variance.tail(4) == before.covariance.diagonal().tail(4));
}

TEST_CASE("a prediction's covariance has parameters, slip noise and pose noise") {
  const MotionModel model(named_basis("edd-2"), {});
  const std::vector<double> t{0.0}, v{1.0}, zero{0.0};
  const InputHistory inputs(t, v, zero, zero);
  const auto at = linearize_segment(model, Eigen::Vector2d::Zero(), inputs, {.start = 0.0, .end = 4.0});
  const Eigen::Matrix2d parameters = Eigen::Vector2d(0.01, 0.04).asDiagonal();
  const MotionNoise shape{.psd_time = {0.25, 0.0, 0.0}, .pose_std_xy = 0.1};
  const Eigen::Matrix3d covariance = prediction_covariance(at, parameters, shape, Eigen::Vector3d(4.0, 1.0, 1.0));
  CHECK(covariance(0, 0) == doctest::Approx(16.0 * 0.01 + 4.0 * (0.25 * 4.0 + 2.0 * 0.01)));
  CHECK(covariance(1, 1) == doctest::Approx(2.0 * 0.01));
}

}  // namespace
}  // namespace slipwise
