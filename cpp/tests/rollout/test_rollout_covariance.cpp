// SPDX-License-Identifier: Apache-2.0
// Covariances along rollouts are those of one linearised segment, and sampled futures scatter like them.
// So holds path_noise.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "rollout/sample_rollouts.hpp"
#include "slipwise/rollout/rollout_covariance.hpp"
#include "slipwise/rollout/sampled_futures.hpp"
#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise {
namespace {

const std::vector<RolloutStart> kOrigin{{{}, {0.4, 0.2}}};

UncertainModel sample_model(const MotionModel& model, const tests::SampleChain& actuator) {
  const Eigen::VectorXd stds = Eigen::VectorXd::LinSpaced(model.size(), 0.01, 0.03);
  Eigen::MatrixXd covariance = stds.cwiseAbs2().asDiagonal();
  covariance(0, 1) = covariance(1, 0) = 0.5 * stds[0] * stds[1];
  return {model,
          tests::sample_parameters(model, actuator),
          {.covariance = covariance,
           .noise = {.psd_time = {1e-4, 2e-4, 1e-4}, .psd_motion = {2e-4, 1e-4, 3e-4}, .fraction = {0.01, 0.02, 0.01}},
           .scale = {1.5, 0.7, 2.0},
           .inflation = 1.2,
           .disturbance = {{{0.0, 0.0, 1.0}, {0.1, 0.3, 0.8}, {0.3, 0.0, 20.0}}, Eigen::Vector3d(0.2, 0.5, 0.3)},
           .prior_std = Eigen::VectorXd::Constant(model.size(), 0.2)},
          {tests::kPeriod}};
}

Eigen::MatrixXd covariance_at(const UncertainModel& model, double seconds) {
  const ModelUncertainty& known = model.uncertainty;
  return covariance_over(model.model, known.covariance, known.disturbance, known.prior_std, seconds);
}

Eigen::Matrix3d matrix_at(const std::vector<double>& entries, std::size_t poses, std::size_t i) {
  const auto e = [&](std::size_t k) { return entries[k * poses + i]; };
  return (Eigen::Matrix3d() << e(0), e(1), e(3), e(1), e(2), e(4), e(3), e(4), e(5)).finished();
}

TEST_CASE("the covariance of a pose is that of its segment in every basis") {
  const tests::SampleCommands<double> all(4, 60, tests::kPeriod);
  const std::vector<DriveCommand> past{{0.5, 0.1}, {0.4, 0.2}, {0.3, 0.2}, {0.4, 0.2}};
  for (const Basis& basis : tests::all_bases()) {
    CAPTURE(basis.name());
    const auto commands = all.for_basis(basis);
    for (const std::size_t which : {std::size_t{3}, std::size_t{6}}) {
      const tests::SampleChain actuator = tests::sample_chains()[which];
      CAPTURE(std::string(actuator.name));
      const MotionModel model(basis, actuator.learned);
      const UncertainModel uncertain = sample_model(model, actuator);
      std::vector<double> entries(6 * 4 * 60);
      rollout_covariance(uncertain, commands.batch(kOrigin, past), entries);
      for (std::size_t n = 0; n < 4; ++n) {
        const Segment segment{.start = 0.0, .end = 60 * tests::kPeriod, .initial = BodyTwist{0.4, 0.0, 0.2}};
        const auto at = linearize_segment(model, uncertain.parameters, commands.input_history(n, past), segment);
        const Eigen::Matrix3d root = uncertain.uncertainty.scale.cwiseSqrt().asDiagonal();
        const Eigen::Matrix3d from_parameters =
            at.by_parameter * covariance_at(uncertain, segment.end) * at.by_parameter.transpose();
        const Eigen::Matrix3d from_noise = root * slip_covariance(at.path, uncertain.uncertainty.noise) * root;
        const Eigen::Matrix3d expected = 1.2 * (from_parameters + from_noise);
        const Eigen::Matrix3d found = matrix_at(entries, 4 * 60, 59 * 4 + n);
        CHECK((found - expected).norm() < 1e-6 * expected.norm());
      }
    }
  }
}

TEST_CASE("without noise the parameters' fraction is exact") {
  const tests::SampleCommands<double> commands(3, 40, tests::kPeriod);
  const tests::SampleChain actuator = tests::sample_chains()[0];
  const MotionModel model(named_basis("odd-even-10"), actuator.learned);
  UncertainModel uncertain = sample_model(model, actuator);
  uncertain.uncertainty.noise = {};
  uncertain.uncertainty.inflation = 1.0;
  std::vector<double> entries(6 * 3 * 40);
  rollout_covariance(uncertain, commands.batch(kOrigin), entries);
  for (std::size_t n = 0; n < 3; ++n) {
    const auto at = linearize_segment(model, uncertain.parameters, commands.input_history(n, {}),
                                      {.start = 0.0, .end = 40 * tests::kPeriod});
    const Eigen::Matrix3d expected =
        at.by_parameter * covariance_at(uncertain, 40 * tests::kPeriod) * at.by_parameter.transpose();
    CHECK((matrix_at(entries, 3 * 40, 39 * 3 + n) - expected).norm() < 1e-12 * expected.norm());
  }
}

TEST_CASE("covariances in float lose no digits far from the origin") {
  const std::vector<RolloutStart> far{{{.x = 4e5, .y = 5e6, .theta = 0.3}, {0.4, 0.2}}};
  const tests::SampleChain actuator = tests::sample_chains()[3];
  const MotionModel model(named_basis("odd-even-10"), actuator.learned);
  const UncertainModel uncertain = sample_model(model, actuator);
  const std::size_t poses = std::size_t{4} * 60;
  std::vector<double> wanted(6 * poses);
  std::vector<float> found(6 * poses);
  rollout_covariance(uncertain, tests::SampleCommands<double>(4, 60, tests::kPeriod).batch(far), wanted);
  rollout_covariance(uncertain, tests::SampleCommands<float>(4, 60, tests::kPeriod).batch(far), found);
  const std::vector<double> in_double(found.begin(), found.end());
  for (std::size_t i = 0; i < poses; ++i) {
    const Eigen::Matrix3d expected = matrix_at(wanted, poses, i);
    CHECK((matrix_at(in_double, poses, i) - expected).norm() < 1e-4 * expected.norm());
  }
}

TEST_CASE("sampled futures scatter as the covariance says, from the same seed in the same way") {
  const std::size_t samples = 2000;
  const tests::SampleCommands<double> commands(2, 30, tests::kPeriod);
  const tests::SampleChain actuator = tests::sample_chains()[3];
  const MotionModel model(named_basis("full-linear-6"), actuator.learned);
  UncertainModel uncertain = sample_model(model, actuator);
  uncertain.uncertainty.scale.setOnes();
  const auto batch = commands.batch(kOrigin);
  const std::size_t poses = 2 * 30;
  const auto drawn = [&](std::uint64_t seed, unsigned threads) {
    tests::SamplePaths<double> paths(samples * poses);
    sample_futures(uncertain, batch, seed, {paths.x, paths.y, paths.theta}, {.threads = threads});
    return paths;
  };
  const auto paths = drawn(3, 1);
  CHECK(paths == drawn(3, 2));
  CHECK(paths != drawn(4, 1));
  std::vector<double> entries(6 * poses);
  rollout_covariance(uncertain, batch, entries);
  const std::size_t last = 29 * 2;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (std::size_t s = 0; s < samples; ++s) {
    const std::size_t i = s * poses + last;
    const Eigen::Vector3d pose(paths.x[i], paths.y[i], paths.theta[i]);
    mean += pose / static_cast<double>(samples);
    squares += pose * pose.transpose() / static_cast<double>(samples);
  }
  const Eigen::Matrix3d scatter = squares - mean * mean.transpose();
  const Eigen::Matrix3d expected = matrix_at(entries, poses, last);
  const double tolerance = 4.0 * std::sqrt(2.0 / static_cast<double>(samples));  // four sigma of a sampled variance
  for (Eigen::Index i = 0; i < 3; ++i) {
    CHECK(scatter(i, i) == doctest::Approx(expected(i, i)).epsilon(tolerance));
  }
}

TEST_CASE("an uncertainty that does not fit is refused") {
  const tests::SampleCommands<double> commands(2, 3, tests::kPeriod);
  const tests::SampleChain actuator = tests::sample_chains()[0];
  const MotionModel model(named_basis("edd-2"), actuator.learned);
  UncertainModel uncertain = sample_model(model, actuator);
  std::vector<double> entries(6 * 6), few(5);
  CHECK_THROWS_AS(rollout_covariance(uncertain, commands.batch(kOrigin), few), std::invalid_argument);
  CHECK_THROWS_AS(sample_futures(uncertain, commands.batch(kOrigin), 1, {few, few, few}), std::invalid_argument);
  uncertain.uncertainty.prior_std.resize(0);
  CHECK_THROWS_AS(rollout_covariance(uncertain, commands.batch(kOrigin), entries), std::invalid_argument);
  uncertain.uncertainty.disturbance.weights[0] = 2.0;
  CHECK_THROWS_AS(rollout_covariance(uncertain, commands.batch(kOrigin), entries), std::invalid_argument);
  uncertain.uncertainty.disturbance = {};
  CHECK_NOTHROW(rollout_covariance(uncertain, commands.batch(kOrigin), entries));
  uncertain.uncertainty.inflation = std::nan("");
  CHECK_THROWS_AS(rollout_covariance(uncertain, commands.batch(kOrigin), entries), std::invalid_argument);
  uncertain.uncertainty.inflation = 1.0;
  uncertain.uncertainty.scale[0] = -1.0;
  CHECK_THROWS_AS(rollout_covariance(uncertain, commands.batch(kOrigin), entries), std::invalid_argument);
  uncertain.uncertainty.covariance = Eigen::Matrix3d::Identity();
  CHECK_THROWS_AS(rollout_covariance(uncertain, commands.batch(kOrigin), entries), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
