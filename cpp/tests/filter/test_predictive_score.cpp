// SPDX-License-Identifier: Apache-2.0
// Scores of predictions: the size of the noise is found, and the better model scores higher.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "sample_drives.hpp"
#include "slipwise/filter/predictive_score.hpp"
#include "slipwise/filter/weighting.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

struct Scores {
  double nis = 0.0;
  double log_score = 0.0;
  Eigen::Vector3d scale = Eigen::Vector3d::Zero();
};

/// Mean scores of edd-2 with `slip` over 400 segments, after 100 to settle on the noise, of a robot that slips by
/// (-0.1, -0.3), with this noise.
Scores mean_scores(const Eigen::Vector2d& slip, double noise_std) {
  const MotionModel model(named_basis("edd-2"), {});
  const InputHistory inputs = tests::sampled(tests::sample_drives().front().twist, 0.0, 0.05, 11000);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, noise_std);
  PredictiveScore score(NoiseSettings{});
  Scores mean;
  constexpr int kSegments = 400, kSettled = 100;
  for (int i = 0; i < kSettled + kSegments; ++i) {
    Segment segment{.start = 1.0 + i, .end = 2.0 + i};
    const Pose2 truth = integrate_segment(model, Eigen::Vector2d(-0.1, -0.3), inputs, segment).poses.back();
    segment.measured =
        measured_pose({truth.x + normal(random), truth.y + normal(random), truth.theta + normal(random)});
    const Estimate estimate{slip, Eigen::Matrix2d::Zero()};
    const ScoredSegment scored = score.score(model, estimate, inputs, segment);
    mean.nis += i < kSettled ? 0.0 : scored.nis / kSegments;
    mean.log_score += i < kSettled ? 0.0 : student_log_score(scored.nis, scored.innovation_covariance) / kSegments;
  }
  mean.scale = score.noise_scale();
  return mean;
}

TEST_CASE("the size of the noise is found, so that NIS has its mean of 3") {
  for (const double std : {0.02, 0.2}) {
    CAPTURE(std);
    CHECK(mean_scores({-0.1, -0.3}, std).nis == doctest::Approx(3.0).epsilon(0.15));
  }
  CHECK(mean_scores({-0.1, -0.3}, 0.2).scale.minCoeff() >
        20.0 * mean_scores({-0.1, -0.3}, 0.02).scale.maxCoeff() / 10.0);
}

TEST_CASE("the better model scores higher") {
  CHECK(mean_scores({-0.1, -0.3}, 0.02).log_score > mean_scores({0.0, -0.3}, 0.02).log_score + 0.1);
  CHECK(mean_scores({-0.1, -0.3}, 0.02).log_score > mean_scores({-0.1, 0.0}, 0.02).log_score + 0.1);
}

}  // namespace
}  // namespace slipwise
