// SPDX-License-Identifier: Apache-2.0
// Of several structures, the one that predicts is taken, and what is refuted is dropped.
#include "slipwise/hypotheses/motion_hypotheses.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "simulated_drive.hpp"

namespace slipwise {
namespace {

const MotionNoise kNoise{.psd_time = {1e-4, 1e-4, 1e-4}, .pose_std_xy = 0.01, .pose_std_yaw = 0.004};

HypothesisSettings few_bases() {
  HypothesisSettings settings;
  settings.bases = {{"none", {}, {}, {}}, named_basis("edd-2")};
  return settings;
}

double weight(const MotionHypotheses& all, Structure structure) {
  return all.structures().weights().at(static_cast<std::size_t>(structure));
}

/// Learns a drive of a robot that loses a part of its turns, behind lags [s] and delays of 0.1 s, or without any.
void learn(MotionHypotheses& all, double yaw_slip, double lag, bool wheels_known = false) {
  const MotionModel model(named_basis("edd-2"), {.dynamics = lag > 0.0});
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(model.size());
  truth[1] = yaw_slip;
  if (lag > 0.0) {
    truth.tail(4) << std::log(lag), std::log(lag), std::log(0.1), std::log(0.1);
  }
  const auto drive = tests::simulate_drive(model, truth, {.seed = 31, .windows = 60, .window = 1.5, .noise = kNoise});
  for (const Segment& segment : drive.segments) {
    all.start({.inputs = drive.inputs, .segment = segment, .known_at = segment.end}, wheels_known);
    while (all.advance()) {
    }
    const auto& weights = all.structures().weights();
    REQUIRE(std::accumulate(weights.begin(), weights.end(), 0.0) == doctest::Approx(1.0));
  }
}

TEST_CASE("a robot that does what it is commanded is explained by the kinematic baseline") {
  MotionHypotheses all(few_bases());
  learn(all, 0.0, 0.0);
  CHECK(all.count() == 60);
  CHECK(all.structures().posterior()->structure == Structure::Baseline);
  CHECK(all.structures().slip_posterior()->structure != Structure::Baseline);
}

TEST_CASE("a robot that lags and slips refutes what has neither, for good") {
  MotionHypotheses all(few_bases());
  learn(all, -0.3, 0.8);
  CHECK(all.structures().posterior()->structure == Structure::Joint);
  for (const Structure simple : {Structure::Baseline, Structure::Direct}) {
    CHECK(weight(all, simple) == 0.0);
    CHECK(all.structures().of(simple) == nullptr);
  }
  learn(all, 0.0, 0.0);
  CHECK(all.structures().of(Structure::Baseline) == nullptr);
}

TEST_CASE("the cascade is tried once wheel speeds come, with the weight that it would have had") {
  MotionHypotheses all(few_bases());
  CHECK(all.structures().of(Structure::Cascaded) == nullptr);
  all.start({.inputs = {}, .segment = {.start = 0.0, .end = 1.0}, .known_at = 1.0}, true);
  REQUIRE(all.structures().of(Structure::Cascaded) != nullptr);
  CHECK(weight(all, Structure::Cascaded) == doctest::Approx(weight(all, Structure::Joint)));
  const auto& weights = all.structures().weights();
  CHECK(std::accumulate(weights.begin(), weights.end(), 0.0) == doctest::Approx(1.0));
}

TEST_CASE("from wheel speeds there is neither a lag nor a cascade to try") {
  HypothesisSettings settings = few_bases();
  settings.dynamics = false;
  MotionHypotheses all(settings);
  CHECK(weight(all, Structure::Joint) + weight(all, Structure::Baseline) == doctest::Approx(1.0));
  learn(all, -0.3, 0.0, true);
  CHECK(all.structures().of(Structure::Cascaded) == nullptr);
  CHECK(all.structures().posterior()->structure == Structure::Joint);
  CHECK(all.structures().posterior()->estimate.mean[1] == doctest::Approx(-0.3).epsilon(0.1));
}

}  // namespace
}  // namespace slipwise
