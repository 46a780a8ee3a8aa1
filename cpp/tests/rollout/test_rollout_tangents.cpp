// SPDX-License-Identifier: Apache-2.0
// The tangents of rollouts are central differences of rollouts, through every stage that a robot may have.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "rollout/sample_rollouts.hpp"
#include "slipwise/linear/symmetric_eigen.hpp"
#include "slipwise/rollout/rollout_covariance.hpp"

namespace slipwise {
namespace {

constexpr double kStep = 1e-4;
constexpr std::size_t kRollouts = 5, kPeriods = 40, kPoses = kRollouts * kPeriods;

/// What a robot drives on and behind.
struct Situation {
  const char* name;
  RolloutSetting setting;
  bool past = true;
  double wheelbase = 0.0;  ///< of a drive that steers
};

std::vector<Situation> situations(Eigen::Index slip) {
  const AxisLimits axis{.dead_band = 0.05, .saturation = 1.1, .slew_rate_up = 0.8, .slew_rate_down = 1.7};
  const SlipAhead ahead{
      .edges = {0.31, 0.87},
      .changes = {Eigen::VectorXd::LinSpaced(slip, -0.05, 0.05), Eigen::VectorXd::LinSpaced(slip, 0.1, -0.1)}};
  const auto with = [](const auto& change) {
    RolloutSetting setting{.period = tests::kPeriod};
    change(setting);
    return setting;
  };
  return {{"level", {.period = tests::kPeriod}},
          {"nothing sent before", {.period = tests::kPeriod}, false},
          {"gravity along the robot", {.period = tests::kPeriod, .gx = 0.7, .gy = -0.4}},
          {"a grade", with([](RolloutSetting& s) { s.rise_x = 0.2, s.rise_y = -0.15; })},
          {"edges", with([&](RolloutSetting& s) { s.ahead = ahead; })},
          {"edges on a grade", with([&](RolloutSetting& s) { s.ahead = ahead, s.rise_y = 0.2; })},
          {"saturation and ramps", with([&](RolloutSetting& s) { s.limits = {.speed = axis, .yaw_rate = axis}; })},
          {"limits of the sides", with([&](RolloutSetting& s) { s.limits = {.side = axis, .wheel_separation = 0.5}; })},
          {"steering", {.period = tests::kPeriod}, true, 0.5},
          {"steering, nothing sent before", {.period = tests::kPeriod}, false, 0.5},
          {"sideways", with([](RolloutSetting& s) { s.sideways = true; })}};
}

/// Every parameter is uncertain and hangs together with the others; so is the slip beyond edges.
ModelUncertainty uncertainty_of(const MotionModel& model, const RolloutSetting& setting) {
  const Eigen::Index size = model.size();
  Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(size, size, [](Eigen::Index i, Eigen::Index j) {
    return i == j ? 1.0 : 0.3 * std::sin(static_cast<double>(7 * i + 3 * j));
  });
  root = Eigen::VectorXd::LinSpaced(size, 0.02, 0.01).asDiagonal() * root;
  ModelUncertainty uncertainty{.covariance = root * root.transpose(), .noise = {}};
  if (!setting.ahead.empty()) {
    uncertainty.covariance.topRows(model.slip_size()).setZero();
    uncertainty.covariance.leftCols(model.slip_size()).setZero();
    for (Eigen::Index k = 0; k < 3; ++k) {
      uncertainty.ahead.emplace_back(0.02 * Eigen::MatrixXd::NullaryExpr(model.slip_size(), 3, [&](auto i, auto j) {
                                       return std::cos(static_cast<double>(3 * i + 2 * j + 5 * k));
                                     }));
    }
  }
  return uncertainty;
}

/// J C J^T of every pose from central differences.
std::vector<double> differences(const UncertainModel& model, const RolloutBatch<double>& batch) {
  std::vector<double> sums(6 * kPoses);
  const auto add = [&](const Eigen::VectorXd& direction, const Eigen::MatrixXd& ahead) {
    const auto there = [&](double step) {
      return tests::roll(moved(model, model.parameters + step * direction, step * ahead), batch);
    };
    const tests::SamplePaths<double> plus = there(kStep), minus = there(-kStep);
    for (std::size_t i = 0; i < kPoses; ++i) {
      const std::array<double, 3> by{(plus.x[i] - minus.x[i]) / (2.0 * kStep), (plus.y[i] - minus.y[i]) / (2.0 * kStep),
                                     (plus.theta[i] - minus.theta[i]) / (2.0 * kStep)};
      std::size_t e = 0;
      for (std::size_t b = 0; b < 3; ++b) {
        for (std::size_t a = 0; a <= b; ++a) {
          sums[e++ * kPoses + i] += by[a] * by[b];
        }
      }
    }
  };
  const Eigen::MatrixXd root = covariance_root(model.uncertainty.covariance);
  for (Eigen::Index j = 0; j < root.cols(); ++j) {
    add(root.col(j), Eigen::MatrixXd{});
  }
  for (const Eigen::MatrixXd& direction : model.uncertainty.ahead) {
    add(Eigen::VectorXd::Zero(model.parameters.size()), direction);
  }
  return sums;
}

/// The largest difference of a covariance, in terms of the largest of its kind in that rollout.
double difference_between(const std::vector<double>& found, const std::vector<double>& wanted) {
  double worst = 0.0;
  for (std::size_t e = 0; e < 6; ++e) {
    for (std::size_t n = 0; n < kRollouts; ++n) {
      double most = 1e-12, apart = 0.0;
      for (std::size_t i = e * kPoses + n; i < (e + 1) * kPoses; i += kRollouts) {
        most = std::max(most, std::abs(wanted[i]));
        apart = std::max(apart, std::abs(found[i] - wanted[i]));
      }
      worst = std::max(worst, apart / most);
    }
  }
  return worst;
}

/// Where a delay ends with a period its differences are taken a little beside that: nothing has a derivative there.
Eigen::VectorXd beside_boundaries(const MotionModel& model, const tests::SampleChain& actuator,
                                  Eigen::VectorXd parameters) {
  if (const std::string name = actuator.name;
      name == "delay of whole periods" || name == "clock offset" || name == "delays alone, one of them negative") {
    const Eigen::Index delay = model.slip_size() + (model.learned().delays ? 0 : 2);
    parameters[delay] += 1e-4;
    parameters[delay + 1] += 2e-4;
  }
  return parameters;
}

void check(const Basis& basis, const tests::SampleChain& actuator, const Situation& situation) {
  CAPTURE(basis.name());
  CAPTURE(std::string(actuator.name));
  CAPTURE(std::string(situation.name));
  ActuatorParameters learned = actuator.learned;
  learned.wheelbase = basis.sideways() ? 0.0 : situation.wheelbase;
  const MotionModel model(basis, learned);
  const Eigen::VectorXd parameters = tests::sample_parameters(model, actuator);
  const UncertainModel uncertain{model, parameters, uncertainty_of(model, situation.setting), situation.setting};
  UncertainModel beside = uncertain;
  beside.parameters = beside_boundaries(model, actuator, parameters);
  const bool sideways = basis.sideways() || situation.setting.sideways;
  const tests::SampleCommands<double> plain(kRollouts, kPeriods, tests::kPeriod);
  const tests::SampleCommands<double> commands = sideways ? plain.sideways() : plain;
  std::vector<RolloutStart> starts;
  std::vector<DriveCommand> past;
  for (std::size_t n = 0; n < kRollouts; ++n) {
    const double at = 0.3 * static_cast<double>(n);
    starts.push_back({{5.0 + at, -3.0, 0.4 + at}, {0.4 + at, 0.2, sideways ? 0.1 : 0.0}});
    past.insert(past.end(), {{0.5, 0.1 + at}, {0.4, 0.2}, {0.3 + at, 0.2}, {0.4, 0.2}});
  }
  const auto batch =
      commands.batch(starts, situation.past ? std::span<const DriveCommand>(past) : std::span<const DriveCommand>());
  tests::SampleCommands<float> few_digits(kRollouts, kPeriods, tests::kPeriod);
  few_digits = sideways ? few_digits.sideways() : few_digits;
  const RolloutBatch<float> with_few_digits = few_digits.batch(batch.starts, batch.past);
  const std::vector<double> wanted = differences(beside, batch);
  const bool beside_them = beside.parameters != parameters;
  for (const InstructionLevel level : kInstructionLevels) {
    if (has_instruction_level(level)) {
      std::vector<double> found(6 * kPoses);
      rollout_covariance(uncertain, batch, found, {}, {.threads = 1, .level = level});
      CAPTURE(name_of(level));
      CHECK(difference_between(found, wanted) < (beside_them ? 3e-2 : 1e-5));
      std::vector<float> in_float(6 * kPoses);
      rollout_covariance(uncertain, with_few_digits, in_float, {}, {.threads = 1, .level = level});
      CHECK(difference_between({in_float.begin(), in_float.end()}, found) < 1e-3);  // 1e-4 without edges
    }
  }
}

TEST_CASE("tangents are central differences, in every basis, through every actuator and in every situation") {
  const std::vector<tests::SampleChain> actuators = tests::sample_chains();
  std::size_t turn = 0;
  for (const Basis& basis : tests::all_bases()) {
    const bool all = basis.name() == "odd-even-10" || basis.name() == "user";
    const std::vector<Situation> there = situations(static_cast<Eigen::Index>(basis.size()));
    for (const tests::SampleChain& actuator : actuators) {
      for (std::size_t i = 0; i < (all ? there.size() : 1); ++i) {
        check(basis, actuator, there[(all ? i : turn++) % there.size()]);
      }
    }
  }
}

TEST_CASE("a step that turns by more than the plain series reaches has tangents") {
  const MotionModel model(named_basis("odd-even-10"), {});
  const RolloutSetting setting{.period = tests::kPeriod};
  const UncertainModel uncertain{model, tests::sample_slip(model.basis(), 31), uncertainty_of(model, setting), setting};
  const tests::SampleCommands<double> commands(kRollouts, kPeriods, tests::kPeriod, 25.0);
  const std::vector<RolloutStart> start{{{}, {0.4, 0.2}}};
  const auto batch = commands.batch(start);
  std::vector<double> found(6 * kPoses);
  rollout_covariance(uncertain, batch, found);
  CHECK(difference_between(found, differences(uncertain, batch)) < 1e-4);
}

}  // namespace
}  // namespace slipwise
