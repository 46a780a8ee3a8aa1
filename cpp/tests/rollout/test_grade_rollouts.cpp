// SPDX-License-Identifier: Apache-2.0
// Rollouts on a plane that is not level are those of the integrator there.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>

#include "sample_rollouts.hpp"

namespace slipwise {
namespace {

constexpr double kRiseX = 0.12;
constexpr double kRiseY = -0.2;

template <typename Scalar>
double error_on_grade(const MotionModel& model, const Eigen::VectorXd& parameters,
                      const tests::SampleCommands<Scalar>& commands, InstructionLevel level) {
  const RolloutProgram program(model, parameters, {.period = tests::kPeriod, .rise_x = kRiseX, .rise_y = kRiseY});
  const auto paths =
      tests::roll(program, commands.batch(tests::kStart, tests::kTurnedPast), {.threads = 1, .level = level});
  const double c = std::cos(tests::kStart[0].pose.theta);
  const double s = std::sin(tests::kStart[0].pose.theta);
  const auto ground =
      std::make_shared<const Ground>(Grade{.rise_x = kRiseX * c + kRiseY * s, .rise_y = kRiseY * c - kRiseX * s});
  double worst = 0.0;
  for (std::size_t n = 0; n < commands.rollouts; n += 5) {
    Segment segment{.start = 0.0,
                    .end = tests::kPeriod * static_cast<double>(commands.periods),
                    .initial = BodyTwist{tests::kStart[0].drive.v, 0.0, tests::kStart[0].drive.omega}};
    segment.ground = ground;
    segment.known = tests::measured_start(model, parameters);
    const SegmentPath path =
        integrate_segment(model, parameters, commands.input_history(n, tests::kTurnedPast), segment);
    const Pose2 end = compose(tests::kStart[0].pose, path.poses.back());
    const std::size_t i = (commands.periods - 1) * commands.rollouts + n;
    worst =
        std::max({worst, std::hypot(static_cast<double>(paths.x[i]) - end.x, static_cast<double>(paths.y[i]) - end.y),
                  std::abs(static_cast<double>(paths.theta[i]) - end.theta)});
  }
  return worst;
}

TEST_CASE("rollouts of 5 s on a grade are those of the integrator in every basis with gravity and every actuator") {
  const tests::SampleCommands<double> commands(37, 100, tests::kPeriod);
  const tests::SampleCommands<float> in_float(37, 100, tests::kPeriod);
  for (const Basis& basis :
       {named_basis("ipem-13"), named_basis("drive-9"), named_basis("thesis-15"), tests::user_basis()}) {
    CAPTURE(basis.name());
    for (const tests::SampleChain& actuator : tests::sample_chains()) {
      CAPTURE(std::string(actuator.name));
      const MotionModel model(basis, actuator.learned);
      const Eigen::VectorXd parameters = tests::sample_parameters(model, actuator);
      // Where commands act amid a period at once, a rollout has two steps in it, and the integrator's begin elsewhere.
      const bool split = std::string(actuator.name) == "early poses";
      for (const InstructionLevel level : kInstructionLevels) {
        if (has_instruction_level(level)) {
          CAPTURE(name_of(level));
          CHECK(error_on_grade(model, parameters, commands, level) < (split ? 5e-5 : 1e-7));
          CHECK(error_on_grade(model, parameters, in_float, level) < 1e-4);
        }
      }
    }
  }
}

TEST_CASE("a plane that is too steep, or comes with a gravity of its own, is refused") {
  const MotionModel model(named_basis("edd-2"), {});
  const Eigen::VectorXd parameters = Eigen::VectorXd::Zero(2);
  CHECK_THROWS_AS(RolloutProgram(model, parameters, {.period = tests::kPeriod, .rise_x = 2.0}), std::invalid_argument);
  CHECK_THROWS_AS(RolloutProgram(model, parameters, {.period = tests::kPeriod, .gx = 0.1, .rise_x = 0.1}),
                  std::invalid_argument);
  CHECK_THROWS_AS(RolloutProgram(model, parameters, {.period = tests::kPeriod, .rise_y = std::nan("")}),
                  std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
