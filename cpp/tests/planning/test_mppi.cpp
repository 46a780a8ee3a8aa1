// SPDX-License-Identifier: Apache-2.0
// The controller follows its reference through the model, within limits, round obstacles, and refuses nonsense.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "sample_manoeuvres.hpp"
#include "slipwise/planning/mppi.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

MppiSettings quick_settings() {
  MppiSettings settings;
  settings.rollouts = 512;
  settings.periods = 30;
  settings.period = 0.1;
  return settings;
}

tests::SampleModel skidding() { return tests::sample_model(named_basis("odd-even-10"), true); }

std::vector<RolloutProgram> programs(const tests::SampleModel& sample, const MppiSettings& settings) {
  return {RolloutProgram(sample.motion, sample.parameters, {.period = settings.period})};
}

MppiReference line(double y, const MppiSettings& settings, double from = 0.0) {
  MppiReference reference;
  for (std::size_t k = 1; k <= settings.periods; ++k) {
    reference.x.push_back(static_cast<float>(from + 0.8 * settings.period * static_cast<double>(k)));
    reference.y.push_back(static_cast<float>(y));
    reference.theta.push_back(0.0F);
  }
  return reference;
}

struct Driven {
  std::vector<Pose2> poses;
  std::vector<DriveCommand> commands;
};

/// Drives the model itself in closed loop along the line y = `y`.
Driven closed_loop(Mppi& controller, const tests::SampleModel& sample, double y, int periods, const Costmap* map) {
  const double period = controller.settings().period;
  Driven driven{.poses = {Pose2{}}, .commands = {}};
  std::vector<double> t, v, vy, omega;
  MppiState state;
  for (int k = 0; k < periods; ++k) {
    const DriveCommand command =
        controller.step(state, line(y, controller.settings(), state.start.pose.x), map).command;
    driven.commands.push_back(command);
    state.past.push_back(command);
    t.push_back(k * period);
    v.push_back(command.v);
    vy.push_back(0.0);
    omega.push_back(command.omega);
    const InputHistory reference(t, v, vy, omega);
    const double now = (k + 1) * period;
    const Segment segment{.start = 0.0, .end = now, .initial = BodyTwist{}};
    const SegmentPath path = integrate_segment(sample.motion, sample.parameters, reference, segment);
    const ActuatorStep& last = path.drive.back();
    state.start = {.pose = path.poses.back(),
                   .drive = {.v = last.forward / last.duration, .omega = last.turn / last.duration}};
    driven.poses.push_back(state.start.pose);
  }
  return driven;
}

/// A square obstacle on the line, with cost falling off around it.
std::vector<float> blocked_cells() {
  std::vector<float> cells(100 * 100);
  for (int row = 0; row < 100; ++row) {
    for (int column = 0; column < 100; ++column) {
      const double x = 0.1 * column - 2.0 + 0.05, y = 0.1 * row - 5.0 + 0.05;
      const double away = std::max(std::abs(x - 3.0) - 0.3, std::abs(y - 0.2) - 0.3);
      cells[static_cast<std::size_t>(row * 100 + column)] =
          away < 0.0 ? 100.0F : static_cast<float>(50.0 * std::max(0.0, 1.0 - away / 0.2));
    }
  }
  return cells;
}

TEST_CASE("the controller drives round an obstacle on its reference") {
  MppiSettings settings = quick_settings();
  settings.periods = 40;
  settings.costs.across = 3.0;
  settings.yaw_rate_std = 0.8;
  const tests::SampleModel sample = skidding();
  Mppi controller(programs(sample, settings), settings);
  const std::vector<float> cells = blocked_cells();
  const Costmap map{.cells = cells, .rows = 100, .columns = 100, .resolution = 0.1, .origin_x = -2.0, .origin_y = -5.0};
  const Driven driven = closed_loop(controller, sample, 0.0, 80, &map);
  CHECK(driven.poses.back().x > 4.0);
  for (const Pose2& pose : driven.poses) {
    CHECK_FALSE((std::abs(pose.x - 3.0) < 0.3 && std::abs(pose.y - 0.2) < 0.3));
  }
}

TEST_CASE("the same seed and state give the same plan") {
  const MppiSettings settings = quick_settings();
  const tests::SampleModel sample = skidding();
  Mppi one(programs(sample, settings), settings), same(programs(sample, settings), settings);
  const MppiReference reference = line(0.5, settings);
  for (int i = 0; i < 3; ++i) {
    const MppiResult a = one.step({}, reference, nullptr), b = same.step({}, reference, nullptr);
    CHECK(a.command.v == b.command.v);
    CHECK(a.command.omega == b.command.omega);
    CHECK(a.effective > 1.0);
    CHECK_FALSE(a.collides);
  }
}

TEST_CASE("risk counts the worst of several models") {
  MppiSettings settings = quick_settings();
  const tests::SampleModel sample = skidding();
  tests::SampleModel other = sample;
  other.parameters.head(other.motion.slip_size()) *= -3.0;
  const std::vector<RolloutProgram> two{programs(sample, settings)[0], programs(other, settings)[0]};
  const MppiReference reference = line(0.5, settings);
  const double mean = Mppi(two, settings).step({}, reference, nullptr).best_cost;
  settings.risk = 1.0;
  CHECK(Mppi(two, settings).step({}, reference, nullptr).best_cost > mean);
}

TEST_CASE("the controller refuses a start in an obstacle, references that do not fit, and settings without sense") {
  const MppiSettings settings = quick_settings();
  const tests::SampleModel sample = skidding();
  Mppi controller(programs(sample, settings), settings);
  const std::vector<float> cells(4, 100.0F);
  const Costmap map{.cells = cells, .rows = 2, .columns = 2, .resolution = 5.0, .origin_x = -5.0, .origin_y = -5.0};
  CHECK_THROWS_AS(controller.step({}, line(0.0, settings), &map), std::invalid_argument);
  CHECK_THROWS_AS(controller.step({}, {}, nullptr), std::invalid_argument);
  MppiReference unknown = line(0.0, settings);
  unknown.y[3] = std::numeric_limits<float>::quiet_NaN();
  CHECK_THROWS_AS(controller.step({}, unknown, nullptr), std::invalid_argument);
  CHECK_THROWS_AS(Mppi({}, settings), std::invalid_argument);
  MppiSettings still = settings;
  still.period = 0.0;
  CHECK_THROWS_AS(Mppi(programs(sample, settings), still), std::invalid_argument);
  still = settings;
  still.limits.lowest_speed = 2.0;
  CHECK_THROWS_AS(Mppi(programs(sample, settings), still), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
