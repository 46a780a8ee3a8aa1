// SPDX-License-Identifier: Apache-2.0
// Where a manoeuvre leads: as the integrator says, with the exact derivative by every parameter.
// So holds speed_profile with its derivatives.
#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <random>
#include <stdexcept>
#include <vector>

#include "finite_difference.hpp"
#include "sample_manoeuvres.hpp"
#include "slipwise/actuator/command_limits.hpp"
#include "slipwise/planning/manoeuvre_end.hpp"
#include "slipwise/segment/elevation_map.hpp"
#include "slipwise/segment/ground.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

const ActuatorState kStart{.drive = {.v = 0.31, .vy = 0.0, .omega = 0.12},
                           .commanded = {.v = 0.4, .vy = 0.0, .omega = 0.1}};

ManoeuvreFrame sample_frame(double direction, double end_speed) {
  return {.speeds = {.start = 0.4, .cruise = 1.1, .end = end_speed},
          .acceleration = 0.6,
          .direction = direction,
          .commands = 20,
          .settling = end_speed > 0.0 ? 0.0 : 1.3};
}

ManoeuvreVector sample_parameters() {
  return (ManoeuvreVector() << 0.25, 0.4, -0.3, 0.2, 0.35, -0.15, 0.1, 4.3).finished();
}

/// The commands as the integrator takes them: what was commanded before the start, then one command after the other.
InputHistory track_of(const HeldCommands& held) {
  std::vector<double> t{-100.0}, v{kStart.commanded.v}, vy{0.0}, omega{kStart.commanded.omega};
  for (std::size_t k = 0; k < held.commands.size(); ++k) {
    t.push_back(static_cast<double>(k) * held.period.value);
    v.push_back(held.commands[k].v);
    vy.push_back(0.0);
    omega.push_back(held.commands[k].omega);
  }
  return {t, v, vy, omega};
}

TEST_CASE("a manoeuvre ends where the integrator says, over all bases and chains") {
  ActuatorState sliding = kStart;
  sliding.drive.vy = 0.2;
  for (const tests::SampleModel& sample : tests::sample_models()) {
    for (const double direction : {1.0, -1.0}) {
      for (const ActuatorState& start : {kStart, sliding}) {
        CAPTURE(sample.name);
        CAPTURE(start.drive.vy);
        const ManoeuvreFrame frame = sample_frame(direction, 0.0);
        const PlanningModel model(sample.motion, sample.parameters);
        const HeldCommands held = held_commands(frame, sample_parameters());
        const double end = frame.commands * held.period.value + frame.settling;
        const Segment segment{.start = 0.0, .end = end, .initial = start.drive};
        const Pose2 expected =
            integrate_segment(sample.motion, sample.parameters, track_of(held), segment).poses.back();
        const Pose2 pose = manoeuvre_pose(model, frame, sample_parameters(), start);
        CHECK((pose.vector() - expected.vector()).norm() < 1e-9);
        const Pose2 linearized = linearize_manoeuvre(model, frame, sample_parameters(), start).pose;
        CHECK((linearized.vector() - pose.vector()).norm() < 1e-12);
      }
    }
  }
}

TEST_CASE("behind limits a manoeuvre ends where the integrator says of the limited commands") {
  const AxisLimits lane{.dead_band = 0.05, .saturation = 1.0, .slew_rate_up = 0.7, .slew_rate_down = 0.9};
  const CommandLimits limits{.speed = lane, .yaw_rate = lane, .side = lane, .wheel_separation = 0.6};
  for (const tests::SampleModel& sample : tests::sample_models()) {
    CAPTURE(sample.name);
    const ManoeuvreFrame frame = sample_frame(1.0, 0.0);
    if (sample.motion.learned().wheelbase > 0.0) {
      CHECK_THROWS_AS(PlanningModel(sample.motion, sample.parameters, limits), std::invalid_argument);
      continue;
    }
    const PlanningModel model(sample.motion, sample.parameters, limits);
    const HeldCommands held = held_commands(frame, sample_parameters());
    const HeldCommands limited = limited_commands(held, limits, kStart.commanded);
    const double period = held.period.value;
    std::vector<double> t{-100.0, -period}, v(2, kStart.commanded.v), omega(2, kStart.commanded.omega);
    for (std::size_t k = 0; k < held.commands.size(); ++k) {
      for (int i = 0; i < ramp_pieces(period); ++i) {  // sent again and again, so that all take the same steps
        t.push_back((static_cast<double>(k) + i / static_cast<double>(ramp_pieces(period))) * period);
        v.push_back(held.commands[k].v);
        omega.push_back(held.commands[k].omega);
      }
    }
    const InputHistory history({t, v, std::vector<double>(t.size(), 0.0), omega});
    const double end = frame.commands * period + limited.settling;
    const Segment segment{.start = 0.0, .end = end, .initial = kStart.drive};
    const InputHistory driven = limited_inputs(history, limits, limited.period.value);
    const Pose2 expected = integrate_segment(sample.motion, sample.parameters, driven, segment).poses.back();
    const Pose2 pose = manoeuvre_pose(model, frame, sample_parameters(), kStart);
    CHECK((pose.vector() - expected.vector()).norm() < 1e-5);
    const PlanningModel free(sample.motion, sample.parameters);
    CHECK((manoeuvre_pose(free, frame, sample_parameters(), kStart).vector() - expected.vector()).norm() > 1e-2);
  }
}

TEST_CASE("a manoeuvre's end has the exact derivative by every parameter, over all bases and chains") {
  for (const tests::SampleModel& sample : tests::sample_models()) {
    for (const double end_speed : {0.0, 0.7}) {
      CAPTURE(sample.name);
      const ManoeuvreFrame frame = sample_frame(1.0, end_speed);
      const PlanningModel model(sample.motion, sample.parameters);
      const auto value = [&](const Eigen::VectorXd& p) -> Eigen::VectorXd {
        return manoeuvre_pose(model, frame, p, kStart).vector();
      };
      const auto numeric = tests::finite_difference(value, sample_parameters(), 1e-4);
      const ManoeuvreJacobian exact = linearize_manoeuvre(model, frame, sample_parameters(), kStart).by;
      CHECK(tests::jacobian_error(exact, numeric, 0.1) < 10.0 * tests::kDerivativeTolerance);
    }
  }
}

/// A plane, and a map of rounded hills; both as seen from the start.
std::vector<std::shared_ptr<const Ground>> sample_grounds() {
  Eigen::MatrixXd elevation(41, 41);
  for (Eigen::Index row = 0; row < elevation.rows(); ++row) {
    for (Eigen::Index column = 0; column < elevation.cols(); ++column) {
      elevation(row, column) =
          0.5 * std::sin(0.4 * static_cast<double>(column)) * std::cos(0.3 * static_cast<double>(row));
    }
  }
  const auto map = std::make_shared<const ElevationMap>(elevation, Eigen::Vector2d(-10.0, -10.0), 0.5);
  return {std::make_shared<const Ground>(Grade{0.12, -0.2}),
          std::make_shared<const Ground>(MappedGround{.map = map, .start = {0.4, -0.3, 0.7}})};
}

TEST_CASE("on a plane and on hills a manoeuvre ends where the integrator says, over all bases and chains") {
  for (const tests::SampleModel& sample : tests::sample_models()) {
    for (const auto& ground : sample_grounds()) {
      CAPTURE(sample.name);
      ManoeuvreFrame frame = sample_frame(1.0, 0.0);
      const PlanningModel model(sample.motion, sample.parameters);
      const HeldCommands held = held_commands(frame, sample_parameters());
      const double end = frame.commands * held.period.value + frame.settling;
      const Segment segment{.start = 0.0, .end = end, .initial = kStart.drive, .ground = ground};
      const Pose2 expected = integrate_segment(sample.motion, sample.parameters, track_of(held), segment).poses.back();
      const Pose2 level = manoeuvre_pose(model, frame, sample_parameters(), kStart);
      frame.ground = ground;
      const Pose2 pose = manoeuvre_pose(model, frame, sample_parameters(), kStart);
      CHECK((pose.vector() - expected.vector()).norm() < 1e-9);
      CHECK((pose.vector() - level.vector()).norm() > 1e-2);
      const Pose2 linearized = linearize_manoeuvre(model, frame, sample_parameters(), kStart).pose;
      CHECK((linearized.vector() - pose.vector()).norm() < 1e-12);
    }
  }
}

TEST_CASE("on a plane and on hills the derivative of a manoeuvre's end is exact") {
  for (const tests::SampleModel& sample : tests::sample_models()) {
    for (const auto& ground : sample_grounds()) {
      CAPTURE(sample.name);
      ManoeuvreFrame frame = sample_frame(1.0, 0.7);
      frame.ground = ground;
      const PlanningModel model(sample.motion, sample.parameters);
      const auto value = [&](const Eigen::VectorXd& p) -> Eigen::VectorXd {
        return manoeuvre_pose(model, frame, p, kStart).vector();
      };
      const auto numeric = tests::finite_difference(value, sample_parameters(), 1e-4);
      const ManoeuvreJacobian exact = linearize_manoeuvre(model, frame, sample_parameters(), kStart).by;
      CHECK(tests::jacobian_error(exact, numeric, 0.1) < 10.0 * tests::kDerivativeTolerance);
    }
  }
}

TEST_CASE("a manoeuvre's commands cover its length and end with the speed at the end") {
  const HeldCommands held = held_commands(sample_frame(-1.0, 0.7), sample_parameters());
  double length = 0.0;
  for (std::size_t k = 0; k + 1 < held.commands.size(); ++k) {
    CHECK(held.commands[k].v < 0.0);
    length -= held.commands[k].v * held.period.value;
  }
  CHECK(length == doctest::Approx(sample_parameters()[kLength]));
  CHECK(held.commands.back().v == -0.7);
}

}  // namespace
}  // namespace slipwise
