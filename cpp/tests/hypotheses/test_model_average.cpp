// SPDX-License-Identifier: Apache-2.0
// Averaging models: weights that follow the predictions, and an average that is a model itself.
#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>

#include "simulated_drive.hpp"
#include "slipwise/hypotheses/model_average.hpp"
#include "slipwise/linear/symmetric_eigen.hpp"

namespace slipwise {
namespace {

const MotionNoise kAverageNoise{.psd_time = {1e-4, 1e-4, 1e-4}, .pose_std_xy = 0.01, .pose_std_yaw = 0.004};

Basis plain() { return {"none", {}, {}, {}}; }

const CausalFilterSettings kBlind{.branches = {.follow = false}};

ModelAverage learned(const std::vector<Basis>& bases, const MotionModel& real, const Eigen::VectorXd& truth,
                     const CausalFilterSettings& settings = {}) {
  ModelAverage average("auto", bases, {}, settings, {});
  const auto drive =
      tests::simulate_drive(real, truth, {.seed = 81, .windows = 80, .window = 2.0, .noise = kAverageNoise});
  for (const Segment& segment : drive.segments) {
    average.learn(drive.inputs, segment);
  }
  return average;
}

TEST_CASE("the weights sum to one and favour the model that is true") {
  const MotionModel real(named_basis("full-linear-6"), {});
  Eigen::VectorXd truth(6);
  truth << -0.05, 0.1, 0.02, 0.2, 0.05, -0.35;
  const AverageState state =
      learned({plain(), named_basis("edd-2"), named_basis("full-linear-6")}, real, truth).state();
  CHECK(state.weights.sum() == doctest::Approx(1.0));
  CHECK(state.weights[2] > 0.8);
}

TEST_CASE("a model that was wrong comes back when the terrain changes and nobody notices") {
  const MotionModel real(named_basis("edd-2"), {});
  ModelAverage average = learned({plain(), named_basis("edd-2")}, real, Eigen::Vector2d(-0.1, -0.4), kBlind);
  CHECK(average.state().weights[0] < 0.05);
  const auto firm = tests::simulate_drive(real, Eigen::Vector2d::Zero(),
                                          {.seed = 82, .windows = 30, .window = 2.0, .noise = kAverageNoise});
  for (const Segment& segment : firm.segments) {
    average.learn(firm.inputs, segment);
  }
  CHECK(average.state().weights[0] > 0.5);
}

TEST_CASE("a segment is learned in pieces as it is at once, alarms included") {
  const MotionModel real(named_basis("edd-2"), {});
  const std::vector<Basis> bases{plain(), named_basis("edd-2")};
  ModelAverage whole("auto", bases, {}, {}, {});
  ModelAverage pieces = whole;
  int alarms = 0;
  for (const double yaw_slip : {-0.4, 0.0}) {
    const auto drive = tests::simulate_drive(real, Eigen::Vector2d(-0.1, yaw_slip),
                                             {.seed = 83, .windows = 40, .window = 2.0, .noise = kAverageNoise});
    for (const Segment& segment : drive.segments) {
      whole.learn(drive.inputs, segment);
      pieces.start(drive.inputs, segment);
      std::size_t count = 1;
      while (pieces.advance()) {
        ++count;
      }
      CHECK(count >= bases.size());
      alarms += pieces.change().alarm ? 1 : 0;
      CHECK(pieces.update().nis == whole.update().nis);
      CHECK(pieces.state().estimate.mean == whole.state().estimate.mean);
      CHECK(pieces.state().weights == whole.state().weights);
    }
    CHECK_FALSE(pieces.advance());
  }
  CHECK(alarms > 0);
}

TEST_CASE("a segment that is not finished is learned before the next one") {
  const MotionModel real(named_basis("edd-2"), {});
  const auto drive = tests::simulate_drive(real, Eigen::Vector2d(-0.1, -0.4),
                                           {.seed = 84, .windows = 10, .window = 2.0, .noise = kAverageNoise});
  ModelAverage whole("auto", {plain(), named_basis("edd-2")}, {}, {}, {});
  ModelAverage pieces = whole;
  for (const Segment& segment : drive.segments) {
    whole.learn(drive.inputs, segment);
    pieces.start(drive.inputs, segment);
    pieces.advance();
  }
  while (pieces.advance()) {
  }
  CHECK(pieces.state().estimate.mean == whole.state().estimate.mean);
}

TEST_CASE("one basis is its own average") {
  const Basis basis = named_basis("edd-2");
  const MotionModel real(basis, {});
  const ModelAverage average = learned({basis}, real, Eigen::Vector2d(-0.1, -0.4));
  CHECK(average.model().basis().name() == "edd-2");
  CHECK(average.state().weights[0] == doctest::Approx(1.0));
  CHECK(average.state().estimate.mean[1] == doctest::Approx(-0.4).epsilon(0.05));
}

TEST_CASE("the average has every term once and a covariance that is one") {
  const MotionModel real(named_basis("edd-2"), {});
  const ModelAverage average =
      learned({plain(), named_basis("edd-2"), named_basis("ipem-9")}, real, Eigen::Vector2d(-0.1, -0.4));
  const AverageState state = average.state();
  CHECK(average.model().size() == 9);  // ipem-9 has both terms of edd-2
  CHECK(symmetric_eigen(state.estimate.covariance).values.minCoeff() >= -1e-12);
  CHECK((state.variance_ratio.array() > 0.0).all());
  CHECK(state.variance_ratio[0] < 0.1);
}

TEST_CASE("before any data nothing is determined, and the largest_basis basis has its prior weight") {
  const ModelAverage average("auto", {plain(), named_basis("edd-2"), named_basis("drive-5")}, {}, {}, {});
  const AverageState state = average.state();
  CHECK(state.weights.isApprox(Eigen::Vector3d(0.3, 0.3, 0.4)));
  CHECK(state.variance_ratio.isApproxToConstant(1.0));
  CHECK(state.estimate.mean.isZero());
}

TEST_CASE("a basis with terms of gravity has little weight before it has earned it, and its terms are not known") {
  const MotionModel real(named_basis("edd-2"), {});
  const std::vector<Basis> bases{plain(), named_basis("edd-2"), named_basis("drive-5"), named_basis("odd-even-13")};
  const ModelAverage before("auto", bases, {}, {}, {});
  CHECK(before.state().weights.isApprox(Eigen::Vector4d(0.294, 0.294, 0.392, 0.02)));
  const ModelAverage average = learned(bases, real, Eigen::Vector2d(-0.1, -0.4));
  const AverageState state = average.state();
  CHECK(state.weights[3] < 0.5);
  for (std::size_t i = 0; i < average.model().basis().size(); ++i) {
    if (average.model().basis().terms()[i].by_gravity()) {
      CHECK(state.variance_ratio[static_cast<Eigen::Index>(i)] >= 1.0);
    }
  }
  CHECK(ModelAverage("auto", {bases[3]}, {}, {}, {}).state().weights[0] == 1.0);
}

TEST_CASE("reference speeds are the ninetieth percentile of those driven") {
  ModelAverage average("auto", {named_basis("edd-2")}, {}, {}, {});
  const std::vector<double> t{0.0, 8.0}, v{1.0, 4.0}, zero{0.0, 0.0}, omega{0.2, 0.2};
  const InputHistory inputs(t, v, zero, omega);
  average.learn(inputs, {.start = 0.0, .end = 10.0, .measured = measured_pose({5.0, 3.0, 2.0})});
  CHECK(average.reference_speeds().v == doctest::Approx(4.0).epsilon(0.05));
  CHECK(average.reference_speeds().omega == doctest::Approx(0.2).epsilon(0.05));
}

TEST_CASE("a change of terrain is found while driving, and learned faster than without") {
  const MotionModel real(named_basis("edd-2"), {});
  ModelAverage seeing("auto", {named_basis("edd-2")}, {}, {}, {});
  ModelAverage unseeing("auto", {named_basis("edd-2")}, {}, kBlind, {});
  int alarms = 0;
  for (const double slip : {-0.3, -0.6}) {
    const std::size_t windows = slip == -0.3 ? 80 : 20;
    const auto drive = tests::simulate_drive(real, Eigen::Vector2d(-0.05, slip),
                                             {.seed = 83, .windows = windows, .window = 2.0, .noise = kAverageNoise});
    for (std::size_t i = 0; i < windows; ++i) {
      seeing.learn(drive.inputs, drive.segments[i]);
      unseeing.learn(drive.inputs, drive.segments[i]);
      alarms += seeing.change().alarm ? 1 : 0;
      CHECK_FALSE(unseeing.change().alarm);
      if (slip == -0.3) {
        CHECK_FALSE(seeing.change().alarm);
      } else if (i == 2) {
        CHECK(alarms == 1);
      }
    }
  }
  CHECK(std::abs(seeing.state().estimate.mean[1] + 0.6) < 0.5 * std::abs(unseeing.state().estimate.mean[1] + 0.6));
  CHECK(seeing.state().weights.sum() == doctest::Approx(1.0));
  CHECK(seeing.state().weights.size() == 1);
}

TEST_CASE("on a new terrain candidates get as much weight as at first, on the old one ever less") {
  const MotionModel real(named_basis("edd-2"), {});
  const std::vector<double> start{0.0}, zero{0.0};
  const InputHistory parked(start, zero, zero, zero);
  const auto dealt_to_plain = [&](double later_slip) {
    ModelAverage average("auto", {plain(), named_basis("edd-2")}, {}, {}, {});
    int alarms = 0;
    for (const double slip : {-0.3, later_slip}) {
      const std::size_t windows = slip == -0.3 ? 80 : 50;
      const auto drive = tests::simulate_drive(real, Eigen::Vector2d(-0.05, slip),
                                               {.seed = 83, .windows = windows, .window = 2.0, .noise = kAverageNoise});
      for (const Segment& segment : drive.segments) {
        average.learn(drive.inputs, segment);
        alarms += average.change().alarm ? 1 : 0;
      }
    }
    CHECK(alarms == (later_slip == -0.3 ? 0 : 1));
    CHECK(average.state().weights[0] < 1e-3);
    average.learn(parked, {.start = 0.0, .end = 2.0, .measured = measured_pose({})});  // tells nothing of any model
    return average.state().weights[0];
  };
  CHECK(dealt_to_plain(-0.3) == doctest::Approx(0.6 / 161.0).epsilon(0.02));
  CHECK(dealt_to_plain(-0.6) == doctest::Approx(0.6 * 0.05).epsilon(0.02));
}

TEST_CASE("a parked robot forgets nothing") {
  const MotionModel real(named_basis("edd-2"), {});
  ModelAverage average = learned({named_basis("edd-2")}, real, Eigen::Vector2d(-0.1, -0.4));
  const Eigen::MatrixXd before = average.state().estimate.covariance;
  const std::vector<double> t{0.0}, zero{0.0};
  const InputHistory parked(t, zero, zero, zero);
  for (int i = 0; i < 50; ++i) {
    average.learn(parked, {.start = 2.0 * i, .end = 2.0 * i + 2.0, .measured = measured_pose({0.1, -0.1, 0.05})});
    CHECK_FALSE(average.change().alarm);
  }
  CHECK(average.state().estimate.covariance.isApprox(before));
}

TEST_CASE("no basis at all is refused") {
  CHECK_THROWS_AS(ModelAverage("auto", {}, {}, {}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
