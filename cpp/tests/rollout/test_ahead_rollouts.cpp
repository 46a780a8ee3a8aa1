// SPDX-License-Identifier: Apache-2.0
// Rollouts over several surfaces are those of the integrator there, and their covariance is that of its derivatives.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>

#include "sample_rollouts.hpp"
#include "slipwise/disturbance/ahead_prediction.hpp"
#include "slipwise/rollout/rollout_covariance.hpp"
#include "slipwise/rollout/sampled_futures.hpp"

namespace slipwise {
namespace {

SlipAhead two_edges(Eigen::Index slip) {
  return {.edges = {0.8, 2.3},
          .changes = {Eigen::VectorXd::LinSpaced(slip, -0.05, 0.05), Eigen::VectorXd::LinSpaced(slip, 0.1, -0.1)}};
}

Segment segment_of(const tests::SampleCommands<double>& commands) {
  return {.start = 0.0,
          .end = tests::kPeriod * static_cast<double>(commands.periods),
          .initial = BodyTwist{tests::kStart[0].drive.v, 0.0, tests::kStart[0].drive.omega}};
}

template <typename Scalar>
double error(const MotionModel& model, const Eigen::VectorXd& parameters, const tests::SampleCommands<Scalar>& commands,
             InstructionLevel level, double rise) {
  const SlipAhead ahead = two_edges(model.slip_size());
  const RolloutProgram program(model, parameters, {.period = tests::kPeriod, .rise_x = rise, .ahead = ahead});
  const auto paths =
      tests::roll(program, commands.batch(tests::kStart, tests::kTurnedPast), {.threads = 1, .level = level});
  const double theta = tests::kStart[0].pose.theta;
  double worst = 0.0;
  for (std::size_t n = 0; n < commands.rollouts; n += 5) {
    Segment segment{.start = 0.0,
                    .end = tests::kPeriod * static_cast<double>(commands.periods),
                    .initial = BodyTwist{tests::kStart[0].drive.v, 0.0, tests::kStart[0].drive.omega}};
    segment.known = tests::measured_start(model, parameters);
    if (rise != 0.0) {
      segment.ground =
          std::make_shared<const Ground>(Grade{.rise_x = rise * std::cos(theta), .rise_y = -rise * std::sin(theta)});
    }
    const SegmentPath path = integrate_segment(model, parameters, commands.input_history(n, tests::kTurnedPast),
                                               segment, Integrator::Exact, ahead);
    const Pose2 end = compose(tests::kStart[0].pose, path.poses.back());
    const std::size_t i = (commands.periods - 1) * commands.rollouts + n;
    worst =
        std::max({worst, std::hypot(static_cast<double>(paths.x[i]) - end.x, static_cast<double>(paths.y[i]) - end.y),
                  std::abs(static_cast<double>(paths.theta[i]) - end.theta)});
  }
  return worst;
}

TEST_CASE("rollouts of 5 s over three surfaces are those of the integrator in every basis and every actuator") {
  const tests::SampleCommands<double> commands(37, 100, tests::kPeriod);
  const tests::SampleCommands<float> in_float(37, 100, tests::kPeriod);
  for (const Basis& basis : {named_basis("edd-2"), named_basis("drive-9"), named_basis("thesis-15")}) {
    CAPTURE(basis.name());
    for (const tests::SampleChain& actuator : tests::sample_chains()) {
      CAPTURE(std::string(actuator.name));
      const MotionModel model(basis, actuator.learned);
      const Eigen::VectorXd parameters = tests::sample_parameters(model, actuator);
      // Where commands act amid a period, steps on an edge have other lengths.
      const bool split = std::string(actuator.name) == "early poses";
      for (const InstructionLevel level : kInstructionLevels) {
        if (has_instruction_level(level)) {
          CAPTURE(name_of(level));
          CHECK(error(model, parameters, commands, level, 0.0) < (split ? 2e-4 : 1e-9));
          CHECK(error(model, parameters, in_float, level, 0.0) < (split ? 3e-4 : 1e-4));
          CHECK(error(model, parameters, commands, level, 0.1) < (split ? 2e-4 : 1e-7));
        }
      }
    }
  }
}

UncertainModel uncertain_model(const MotionModel& model, const MixedAhead& mixed) {
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(model.size());
  parameters.head(model.slip_size()) = mixed.slip;
  return {.model = model,
          .parameters = parameters,
          .uncertainty = {.covariance = Eigen::MatrixXd::Zero(model.size(), model.size()),
                          .noise = {},
                          .prior_std = Eigen::VectorXd::Ones(model.size()),
                          .ahead = mixed.directions},
          .setting = {.period = tests::kPeriod, .ahead = mixed.ahead}};
}

MixedAhead mixed_ahead() {
  const std::vector<SurfaceMoments> surfaces{{Eigen::Vector2d(-0.05, -0.1), 1e-4 * Eigen::Matrix2d::Identity()},
                                             {Eigen::Vector2d(-0.15, -0.4), 4e-4 * Eigen::Matrix2d::Identity()}};
  return mix_ahead({1.0}, (Eigen::Matrix2d() << 1.0, 0.0, 0.3, 0.7).finished(), surfaces);
}

TEST_CASE("the covariance of rollouts is that of a prediction, and of futures drawn") {
  const MotionModel model(named_basis("edd-2"), {});
  const MixedAhead mixed = mixed_ahead();
  const UncertainModel uncertain = uncertain_model(model, mixed);
  const tests::SampleCommands<double> commands(2, 60, tests::kPeriod);
  const std::vector<RolloutStart> origin{{{}, {0.4, 0.2}}};
  const auto batch = commands.batch(origin, tests::kTurnedPast);
  std::vector<double> covariance(6 * 120);
  rollout_covariance(uncertain, batch, covariance);
  const MotionPosterior posterior{model,
                                  {uncertain.parameters, Eigen::MatrixXd::Zero(2, 2)},
                                  Eigen::VectorXd::Ones(2),
                                  {},
                                  Eigen::Vector3d::Ones()};
  const DisturbanceFilter still;
  const ExpectedPose expected =
      predict_ahead(still, posterior, {},
                    {.inputs = commands.input_history(0, tests::kTurnedPast), .segment = segment_of(commands)}, mixed);
  const std::size_t last = 59 * 2;
  CHECK(covariance[last] == doctest::Approx(expected.covariance(0, 0)).epsilon(0.02));
  CHECK(covariance[120 + last] == doctest::Approx(expected.covariance(0, 1)).epsilon(0.02));
  CHECK(covariance[5 * 120 + last] == doctest::Approx(expected.covariance(2, 2)).epsilon(0.02));

  constexpr std::size_t kSamples = 400;
  std::vector<double> x(kSamples * 120);
  std::vector<double> y(kSamples * 120);
  std::vector<double> theta(kSamples * 120);
  sample_futures(uncertain, batch, 3, {x, y, theta});
  double mean = 0.0;
  double square = 0.0;
  for (std::size_t s = 0; s < kSamples; ++s) {
    mean += theta[s * 120 + last] / kSamples;
    square += theta[s * 120 + last] * theta[s * 120 + last] / kSamples;
  }
  CHECK(square - mean * mean == doctest::Approx(covariance[5 * 120 + last]).epsilon(0.2));
}

TEST_CASE("slip ahead of other terms is refused") {
  const MotionModel model(named_basis("edd-2"), {});
  const Eigen::VectorXd parameters = Eigen::VectorXd::Zero(2);
  CHECK_THROWS_AS(RolloutProgram(model, parameters, {.period = tests::kPeriod, .ahead = two_edges(3)}),
                  std::invalid_argument);
  UncertainModel uncertain = uncertain_model(model, mixed_ahead());
  uncertain.uncertainty.ahead.emplace_back(Eigen::MatrixXd::Zero(2, 1));
  CHECK_THROWS_AS(check_uncertainty(uncertain), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
