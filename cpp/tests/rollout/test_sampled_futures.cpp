// SPDX-License-Identifier: Apache-2.0
// Drawn futures: without uncertainty they are the path, with it they scatter as stated, and a seed fixes them.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "rollout/sample_rollouts.hpp"
#include "slipwise/rollout/sampled_futures.hpp"

namespace slipwise {
namespace {

const MotionModel& sample_motion() {
  static const MotionModel model(named_basis("drive-5"), {});
  return model;
}

constexpr std::size_t kFutures = 3, kFuturePeriods = 12;
const std::array<RolloutStart, 1> kOneStart{{{.pose = {.x = 1.0, .y = 2.0, .theta = 0.5}, .drive = {}}}};

UncertainModel sample(double std) {
  return {.model = sample_motion(),
          .parameters = tests::sample_slip(sample_motion().basis(), 3),
          .uncertainty = {.covariance = std * std * Eigen::MatrixXd::Identity(5, 5), .noise = {}},
          .setting = {.period = 0.1}};
}

struct Futures {
  std::vector<double> x, y, theta;
  explicit Futures(std::size_t samples) : x(samples * kFuturePeriods * kFutures), y(x.size()), theta(x.size()) {}
  bool operator==(const Futures&) const = default;
};

Futures draw(const UncertainModel& model, std::size_t samples, std::uint64_t seed, unsigned threads = 1) {
  const tests::SampleCommands<double> commands(kFutures, kFuturePeriods, 0.1);
  Futures futures(samples);
  sample_futures(model, commands.batch(kOneStart), seed, {futures.x, futures.y, futures.theta}, {.threads = threads});
  return futures;
}

TEST_CASE("a model that is sure drives its one path in every sample") {
  const tests::SampleCommands<double> commands(kFutures, kFuturePeriods, 0.1);
  const UncertainModel model = sample(0.0);
  const auto path =
      tests::roll(RolloutProgram(sample_motion(), model.parameters, model.setting), commands.batch(kOneStart));
  const Futures futures = draw(model, 2, 7);
  for (std::size_t i = 0; i < futures.x.size(); ++i) {
    CHECK(futures.x[i] == doctest::Approx(path.x[i % path.x.size()]).epsilon(1e-9));
    CHECK(futures.y[i] == doctest::Approx(path.y[i % path.x.size()]).epsilon(1e-9));
    CHECK(futures.theta[i] == doctest::Approx(path.theta[i % path.x.size()]).epsilon(1e-9));
  }
}

TEST_CASE("futures in float are those in double, from the same random numbers") {
  UncertainModel model = sample(0.05);
  model.uncertainty.noise = {
      .psd_time = {1e-4, 1e-4, 1e-4}, .psd_motion = {1e-3, 1e-3, 1e-3}, .fraction = {0.1, 0.1, 0.1}};
  const Futures wanted = draw(model, 5, 7);
  const tests::SampleCommands<float> commands(kFutures, kFuturePeriods, 0.1);
  std::vector<float> x(wanted.x.size()), y(x.size()), theta(x.size());
  sample_futures(model, commands.batch(kOneStart), 7, {x, y, theta});
  for (std::size_t i = 0; i < x.size(); ++i) {
    CHECK(std::abs(static_cast<double>(x[i]) - wanted.x[i]) < 1e-5);
    CHECK(std::abs(static_cast<double>(y[i]) - wanted.y[i]) < 1e-5);
    CHECK(std::abs(static_cast<double>(theta[i]) - wanted.theta[i]) < 1e-5);
  }
}

TEST_CASE("a seed fixes the bytes at any number of threads; another seed gives others") {
  UncertainModel model = sample(0.05);
  model.uncertainty.noise.psd_motion = {1e-3, 1e-3, 1e-3};
  const Futures one = draw(model, 5, 7);
  CHECK(one == draw(model, 5, 7, 3));
  CHECK_FALSE(one == draw(model, 5, 8));
}

TEST_CASE("drawn parameters have the mean and the covariance that are stated, widened by the inflation") {
  UncertainModel model = sample(0.2);
  model.uncertainty.covariance(0, 1) = model.uncertainty.covariance(1, 0) = 0.03;
  model.uncertainty.inflation = 2.0;
  constexpr std::size_t kSamples = 20000;
  const Eigen::MatrixXd drawn = draw_parameters(model, kSamples, 11);
  const Eigen::VectorXd mean = drawn.rowwise().mean();
  const Eigen::MatrixXd centred = drawn.colwise() - mean;
  const Eigen::MatrixXd covariance = centred * centred.transpose() / kSamples;
  const Eigen::MatrixXd wanted = 2.0 * model.uncertainty.covariance;
  CHECK((mean - model.parameters).cwiseAbs().maxCoeff() < 5.0 * std::sqrt(0.08 / kSamples));
  CHECK((covariance - wanted).cwiseAbs().maxCoeff() < 5.0 * 0.08 * std::sqrt(2.0 / kSamples));
}

TEST_CASE("white slip noise scatters the yaw by its sum over the periods") {
  UncertainModel model = sample(0.0);
  model.uncertainty.noise.psd_time = {0.0, 0.0, 0.04};
  constexpr std::size_t kSamples = 4000;
  const Futures futures = draw(model, kSamples, 3);
  double sum = 0.0, squares = 0.0;
  for (std::size_t s = 0; s < kSamples; ++s) {
    const double yaw = futures.theta[(s + 1) * kFuturePeriods * kFutures - 1];  // of the last rollout at the end
    sum += yaw;
    squares += yaw * yaw;
  }
  const double variance = squares / kSamples - sum * sum / kSamples / kSamples;
  CHECK(variance == doctest::Approx(0.04 * 0.1 * kFuturePeriods).epsilon(5.0 * std::sqrt(2.0 / kSamples)));
}

TEST_CASE("no sample at all, or room that does not fit, is refused") {
  const tests::SampleCommands<double> commands(kFutures, kFuturePeriods, 0.1);
  std::vector<double> x(kFuturePeriods * kFutures), few(kFuturePeriods), none;
  const auto draw_into = [&](std::vector<double>& a, std::vector<double>& b) {
    sample_futures(sample(0.1), commands.batch(kOneStart), 1, {a, b, a});
  };
  CHECK_NOTHROW(draw_into(x, x));
  CHECK_THROWS_AS(draw_into(x, few), std::invalid_argument);
  CHECK_THROWS_AS(draw_into(few, few), std::invalid_argument);
  CHECK_THROWS_AS(draw_into(none, none), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
