// SPDX-License-Identifier: Apache-2.0
// The actuator from commands and wheel speeds: found, stated truly, and followed over gaps and outliers.
#include "slipwise/identify/actuator_filter.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

namespace slipwise {
namespace {

constexpr double kPeriod = 0.05, kWheelStd = 0.01;  // [s]; [m/s], [rad/s]
const ActuatorModel kTrue{.time_constant_v = 0.3,
                          .time_constant_omega = 0.15,
                          .delay_v = 0.12,
                          .delay_omega = 0.2,
                          .gain_v = 0.9,
                          .gain_omega = 1.1,
                          .slow_fraction_v = 0.3,
                          .slow_fraction_omega = 0.2,
                          .slow_time_constant_v = 2.5,
                          .slow_time_constant_omega = 1.2};

struct Drive {
  InputHistory commands, wheels;
};

/// Random commands, and wheel speeds that are the mean until the next one.
Drive drive(int seed, double seconds, const ActuatorModel& actuator = kTrue) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> normal(0.0, kWheelStd);
  std::vector<double> t, v, omega, edges;
  for (double now = 0.0; now < seconds; now += 1.0 + 0.8 * uniform(random)) {
    t.push_back(now);
    v.push_back(uniform(random));
    omega.push_back(uniform(random));
  }
  const InputHistory commands(t, v, std::vector<double>(t.size(), 0.0), omega);
  for (int i = 0; i * kPeriod <= seconds; ++i) {
    edges.push_back(i * kPeriod);
  }
  const ActuatorAxis speed{&BodyTwist::v, speed_response(actuator), actuator.delay_v};
  const ActuatorAxis turn{&BodyTwist::omega, yaw_rate_response(actuator), actuator.delay_omega};
  Eigen::VectorXd driven = axis_motion(commands, speed, {}, edges).value;
  Eigen::VectorXd turned = axis_motion(commands, turn, {}, edges).value;
  edges.pop_back();
  std::vector<double> observed_v, observed_omega;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    observed_v.push_back(driven[static_cast<Eigen::Index>(i)] + normal(random));
    observed_omega.push_back(turned[static_cast<Eigen::Index>(i)] + normal(random));
  }
  return {commands, InputHistory(edges, observed_v, std::vector<double>(edges.size(), 0.0), observed_omega)};
}

Eigen::VectorXd truth() {
  Eigen::VectorXd p(10);
  p << std::log(kTrue.time_constant_v), std::log(kTrue.time_constant_omega), std::log(kTrue.delay_v),
      std::log(kTrue.delay_omega), kTrue.gain_v, kTrue.gain_omega, kTrue.slow_fraction_v, kTrue.slow_fraction_omega,
      std::log(kTrue.slow_time_constant_v), std::log(kTrue.slow_time_constant_omega);
  return p;
}

void learn(ActuatorFilter& learner, const Drive& drive, double from, double until) {
  for (double start = from; start + 1.0 <= until + 1e-9; start += 1.0) {
    learner.learn(drive.commands, drive.wheels, start, start + 1.0);
  }
}

TEST_CASE("the actuator is found, and as well as is stated") {
  double squares = 0.0;
  for (int seed = 0; seed < 4; ++seed) {
    ActuatorFilter learner({});
    learn(learner, drive(seed, 130.0), 0.0, 129.0);
    const Estimate found = learner.estimate();
    const Eigen::VectorXd sigmas = (found.mean - truth()).cwiseQuotient(found.covariance.diagonal().cwiseSqrt());
    CHECK(sigmas.cwiseAbs().maxCoeff() < 3.5);
    CHECK((found.covariance.diagonal().cwiseSqrt().cwiseQuotient(learner.prior_std())).maxCoeff() < 0.2);
    squares += sigmas.squaredNorm() / 40.0;
  }
  CHECK(squares > 0.3);
  CHECK(squares < 2.0);
}

TEST_CASE("a robot slower than nominal is not taken for one whose slow mode is the faster one") {
  ActuatorModel sluggish = kTrue;
  sluggish.time_constant_v = 1.35;
  sluggish.slow_time_constant_v = 3.4;
  sluggish.slow_fraction_v = 0.7;
  for (int seed = 20; seed < 28; ++seed) {
    CAPTURE(seed);
    ActuatorFilter learner({});
    learn(learner, drive(seed, 240.0, sluggish), 0.0, 239.0);
    const Estimate found = learner.estimate();
    CHECK(found.mean[8] > found.mean[0]);  // slow lag of speed, and its lag
  }
}

TEST_CASE("windows that waited are learned as those that came one by one") {
  const Drive driven = drive(9, 130.0);
  ActuatorFilter one_by_one({});
  ActuatorFilter waited({}, 129);
  learn(one_by_one, driven, 0.0, 129.0);
  learn(waited, driven, 0.0, 128.0);
  const Estimate before = waited.estimate();
  learn(waited, driven, 128.0, 129.0);
  waited.end_refit();
  one_by_one.end_refit();
  const Estimate expected = one_by_one.estimate();
  const auto away = [&](const Estimate& found) {
    return (found.mean - expected.mean).cwiseQuotient(expected.covariance.diagonal().cwiseSqrt()).cwiseAbs().maxCoeff();
  };
  CHECK(away(waited.estimate()) < 1.0);
  CHECK(away(waited.estimate()) < away(before));
}

TEST_CASE("slices of a refit of the actuator model change nothing but when the work is done") {
  const Drive driven = drive(10, 120.0);
  ActuatorFilter at_once({});
  ActuatorFilter sliced({});
  int slices = 0;
  for (int i = 0; i < 119; ++i) {
    learn(at_once, driven, i, i + 1.0);
    learn(sliced, driven, i, i + 1.0);
    for (int k = 0; k < i % 4; ++k) {
      slices += sliced.refit_slice() ? 1 : 0;
    }
    CHECK(at_once.estimate().mean == sliced.estimate().mean);
    CHECK(at_once.estimate().covariance == sliced.estimate().covariance);
  }
  CHECK(slices > 10);
}

TEST_CASE("after a gap the drive's state is sought again") {
  ActuatorFilter learner({});
  const Drive driven = drive(7, 130.0);
  for (double start = 0.0; start < 120.0; start += 10.0) {
    learn(learner, driven, start, start + 6.0);
  }
  const Estimate found = learner.estimate();
  const Eigen::VectorXd sigmas = (found.mean - truth()).cwiseQuotient(found.covariance.diagonal().cwiseSqrt());
  CHECK(sigmas.cwiseAbs().maxCoeff() < 3.5);
}

TEST_CASE("a window far from what is predicted is commanded so, and changes little") {
  ActuatorFilter learner({});
  const Drive driven = drive(3, 60.0);
  learn(learner, driven, 0.0, 40.0);
  const Estimate before = learner.estimate();
  std::vector<double> t, v, still;
  for (int i = 0; i < 20; ++i) {
    t.push_back(40.0 + i * kPeriod);
    v.push_back(5.0);
    still.push_back(0.0);
  }
  const ActuatorUpdate update = learner.learn(driven.commands, InputHistory(t, v, still, v), 40.0, 41.0);
  CHECK(update.nis > 100.0);
  const Eigen::VectorXd moved = learner.estimate().mean - before.mean;
  CHECK(moved.cwiseQuotient(before.covariance.diagonal().cwiseSqrt()).cwiseAbs().maxCoeff() < 1.0);
}

TEST_CASE("wheels that do exactly what they are commanded teach an actuator that does hardly anything") {
  ActuatorFilter learner({});
  const Drive driven = drive(5, 60.0);
  learn(learner, {driven.commands, driven.commands}, 0.0, 59.0);
  const Estimate found = learner.estimate();
  CHECK(found.covariance.allFinite());
  CHECK(found.covariance.diagonal().minCoeff() > 0.0);
  CHECK(found.mean[4] == doctest::Approx(1.0).epsilon(1e-2));
  CHECK(std::exp(found.mean[0]) + std::exp(found.mean[2]) < 0.03);
}

TEST_CASE("a robot that stands still teaches nothing") {
  ActuatorFilter learner({});
  const std::vector<double> t{0.0, 0.5, 1.0};
  const std::vector<double> still(3, 0.0);
  const InputHistory nothing(t, still, still, still);
  const ActuatorUpdate update = learner.learn(nothing, nothing, 0.0, 1.0);
  CHECK(update.nis == 0.0);
  CHECK((learner.estimate().covariance.diagonal().cwiseSqrt() - learner.prior_std()).norm() < 1e-12);
  CHECK_THROWS_AS(learner.learn(nothing, nothing, 1.0, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
