// SPDX-License-Identifier: Apache-2.0
// Smoothing: equality with a batch solution on a linear problem, and a parameter that drifts.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <vector>

#include "simulated_drive.hpp"
#include "slipwise/filter/rts_smoother.hpp"
#include "slipwise/linear/cholesky.hpp"

namespace slipwise {
namespace {

MotionModel forward_model() {
  const std::vector<std::string> lon{"V"}, none;
  return {Basis("forward", lon, none, none), {}};
}

InputHistory straight() {
  const std::vector<double> t{0.0}, v{1.0}, zero{0.0};
  return {t, v, zero, zero};
}

Estimate prior() { return {Eigen::VectorXd::Constant(1, 0.1), Eigen::MatrixXd::Constant(1, 1, 0.04)}; }
const IekfSettings kTrusting{.huber = 1e9, .gate = 1e18};

/// Two seconds each at 1 m/s; the slip fraction drifts slowly.
std::vector<BatchDatum> drifting_data(const InputHistory& inputs, std::size_t count, std::vector<double>& truth,
                                      std::uint64_t seed = 95) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<BatchDatum> data;
  for (std::size_t i = 0; i < count; ++i) {
    const double start = 1.0 + 2.0 * static_cast<double>(i);
    truth.push_back(0.1 + 0.2 * std::sin(0.1 * static_cast<double>(i)));
    const double observed = 2.0 * (1.0 + truth.back()) + 0.1 * normal(random);
    data.push_back({inputs,
                    {.start = start, .end = start + 2.0, .measured = measured_pose({observed, 0.0, 0.0})},
                    0.01 * Eigen::Matrix3d::Identity()});
  }
  return data;
}

/// All parameters of all segments at once: prior, drift between neighbours, measurements.
Estimate batch(const std::vector<BatchDatum>& data, double a, double added) {
  const auto n = static_cast<Eigen::Index>(data.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd vector = Eigen::VectorXd::Zero(n);  // of p - p0
  for (Eigen::Index i = 0; i < n; ++i) {
    const double z = data[static_cast<std::size_t>(i)].segment.measured.front().z[0] - 2.0 * (1.0 + 0.1);
    information(i, i) += 4.0 / 0.01;
    vector[i] += 2.0 * z / 0.01;
    if (i == 0) {
      information(0, 0) += 1.0 / 0.04;
    } else {
      Eigen::VectorXd row = Eigen::VectorXd::Unit(n, i) - a * Eigen::VectorXd::Unit(n, i - 1);
      information += row * row.transpose() / added;
    }
  }
  const Eigen::MatrixXd covariance = Cholesky(information).inverse();
  return {(covariance * vector).array() + 0.1, covariance};
}

TEST_CASE("on a linear problem the smoother is the batch solution, for both kinds of drift") {
  const InputHistory inputs = straight();
  std::vector<double> truth;
  const auto data = drifting_data(inputs, 30, truth);
  for (const Drift drift : {Drift::RandomWalk, Drift::MeanReverting}) {
    const auto smoothed = rts_smooth(forward_model(), prior(), data, {.drift = drift, .length = 50.0}, kTrusting);
    const double a = drift == Drift::RandomWalk ? 1.0 : std::exp(-2.0 / 50.0);
    const double added = 0.04 * (drift == Drift::RandomWalk ? 2.0 / 50.0 : 1.0 - a * a);
    const Estimate expected = batch(data, a, added);
    for (std::size_t i = 0; i < data.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      CHECK(smoothed[i].mean[0] == doctest::Approx(expected.mean[k]).epsilon(1e-9));
      CHECK(smoothed[i].covariance(0, 0) == doctest::Approx(expected.covariance(k, k)).epsilon(1e-9));
    }
  }
}

TEST_CASE("smoothed drifting slip is nearer to the truth than one constant, and within its sigmas") {
  const InputHistory inputs = straight();
  std::vector<double> truth;
  const auto data = drifting_data(inputs, 100, truth);
  const auto smoothed = rts_smooth(forward_model(), prior(), data, {.length = 30.0}, kTrusting);
  const auto constant = rts_smooth(forward_model(), prior(), data, {.length = 1e12}, kTrusting);
  double squared = 0.0, squared_constant = 0.0, nees = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double error = smoothed[i].mean[0] - truth[i];
    squared += error * error;
    squared_constant += std::pow(constant[i].mean[0] - truth[i], 2);
    nees += error * error / smoothed[i].covariance(0, 0) / static_cast<double>(truth.size());
  }
  CHECK(squared < 0.1 * squared_constant);
  CHECK(nees < 2.0);
}

TEST_CASE("a parked robot forgets nothing, one that drove far is back at its prior") {
  const Estimate known{Eigen::VectorXd::Constant(1, 0.5), Eigen::MatrixXd::Constant(1, 1, 1e-4)};
  for (const Drift drift : {Drift::RandomWalk, Drift::MeanReverting}) {
    const Estimate parked = drifted(known, prior(), 0.0, {.drift = drift, .length = 10.0});
    CHECK(parked.mean == known.mean);
    CHECK(parked.covariance == known.covariance);
  }
  const Estimate far = drifted(known, prior(), 1e4, {.length = 10.0});
  CHECK(far.mean[0] == doctest::Approx(0.1));
  CHECK(far.covariance(0, 0) == doctest::Approx(0.04));
}

TEST_CASE("nothing to smooth and a drift without length are refused") {
  const InputHistory inputs = straight();
  std::vector<double> truth;
  const auto data = drifting_data(inputs, 2, truth);
  CHECK_THROWS_AS(rts_smooth(forward_model(), prior(), {}), std::invalid_argument);
  CHECK_THROWS_AS(rts_smooth(forward_model(), prior(), data, {.length = 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
