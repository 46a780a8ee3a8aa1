// SPDX-License-Identifier: Apache-2.0
// The joint density of segments on a surface that is known.
#include <doctest/doctest.h>

#include "simulated_drive.hpp"
#include "slipwise/hypotheses/surface_evidence.hpp"

namespace slipwise {
namespace {

const MotionNoise kEvidenceNoise{.psd_time = {1e-4, 1e-4, 1e-4}, .pose_std_xy = 0.01, .pose_std_yaw = 0.004};
const DisturbanceModel kWhite{.candidates = {{0.0, 0.0, 1.0}}, .weights = Eigen::VectorXd::Ones(1)};
const DisturbanceModel kColoured{.candidates = {{0.5, 0.5, 20.0}}, .weights = Eigen::VectorXd::Ones(1)};

MotionModel model() { return {named_basis("edd-2"), {}}; }

SurfacePosterior posterior(double forward, double yaw, double std) {
  return {.estimate = {Eigen::Vector2d(forward, yaw), std * std * Eigen::Matrix2d::Identity()},
          .prior_std = Eigen::Vector2d(0.3, 0.3),
          .noise = kEvidenceNoise,
          .noise_scale = Eigen::Vector3d::Ones()};
}

double evidence(const SurfacePosterior& known, const DisturbanceModel& law, double yaw) {
  const auto drive = tests::simulate_drive(model(), Eigen::Vector2d(-0.05, yaw),
                                           {.seed = 21, .windows = 8, .window = 2.0, .noise = kEvidenceNoise});
  SurfaceEvidence sum(model(), known, law);
  double total = 0.0;
  for (const Segment& segment : drive.segments) {
    total += sum.add(model(), drive.inputs, segment);
  }
  return total;
}

TEST_CASE("segments are likeliest on the surface that they were driven on") {
  const SurfacePosterior firm = posterior(-0.05, -0.1, 0.02);
  const SurfacePosterior loose = posterior(-0.05, -0.5, 0.02);
  CHECK(evidence(firm, kWhite, -0.1) > evidence(loose, kWhite, -0.1) + 5.0);
  CHECK(evidence(loose, kWhite, -0.5) > evidence(firm, kWhite, -0.5) + 5.0);
}

TEST_CASE("a surface that is known is likelier than one that could be anything") {
  CHECK(evidence(posterior(-0.05, -0.1, 0.02), kWhite, -0.1) >
        evidence(posterior(-0.05, -0.1, 0.3), kWhite, -0.1) + 1.0);
}

TEST_CASE("segments that miss alike count for less where slip lasts") {
  const double white =
      evidence(posterior(-0.05, -0.2, 0.02), kWhite, -0.1) - evidence(posterior(-0.05, -0.1, 0.02), kWhite, -0.1);
  const double coloured =
      evidence(posterior(-0.05, -0.2, 0.02), kColoured, -0.1) - evidence(posterior(-0.05, -0.1, 0.02), kColoured, -0.1);
  CHECK(white < coloured);
  CHECK(coloured < 0.5);
}

TEST_CASE("a disturbance that weighs nothing changes nothing") {
  const DisturbanceModel both{.candidates = {{0.0, 0.0, 1.0}, {0.5, 0.5, 20.0}}, .weights = Eigen::Vector2d(1.0, 0.0)};
  CHECK(evidence(posterior(-0.05, -0.2, 0.02), both, -0.1) == evidence(posterior(-0.05, -0.2, 0.02), kWhite, -0.1));
}

}  // namespace
}  // namespace slipwise
