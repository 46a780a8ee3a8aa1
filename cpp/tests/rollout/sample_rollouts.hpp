// SPDX-License-Identifier: Apache-2.0
// Batches of made-up commands, and the same drives as the plain integrator sees them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "sample_bases.hpp"
#include "slipwise/rollout/rollout_batch.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise::tests {

inline constexpr double kPeriod = 0.05;  // [s]
inline const std::vector<RolloutStart> kStart{{{1.0, -2.0, 0.5}, {0.4, 0.2}}};
inline const std::vector<DriveCommand> kPast{{0.5, 0.1}, {0.6, 0.0}, {0.5, 0.2}, {0.4, 0.3}};
inline const std::vector<DriveCommand> kTurnedPast{{0.2, 0.1}, {0.5, -0.2}, {0.4, 0.3}, {0.3, 0.2}};

/// Smoothly changing commands, forwards, backwards and spinning, side by side over the rollouts.
template <typename Scalar>
struct SampleCommands {
  std::size_t rollouts;
  std::size_t periods;
  double period;
  std::vector<Scalar> v, omega;
  std::vector<Scalar> vy = {};  ///< of a robot that drives sideways

  SampleCommands(std::size_t n, std::size_t k, double dt, double fastest_turn = 1.0)
      : rollouts(n), periods(k), period(dt) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<double> shape(4 * n);
    for (double& number : shape) {
      number = uniform(random);
    }
    for (std::size_t j = 0; j < k; ++j) {
      for (std::size_t i = 0; i < n; ++i) {
        const double t = dt * static_cast<double>(j);
        const double forward = i % 3 == 0 ? -1.0 : 1.0;
        v.push_back(static_cast<Scalar>(forward * (0.9 + 0.5 * std::sin(shape[4 * i] * 3.0 * t))));
        omega.push_back(
            static_cast<Scalar>(fastest_turn * std::sin(shape[4 * i + 1] * 2.0 * t + 6.0 * shape[4 * i + 2])));
      }
    }
  }

  /// The same commands, sideways too: for a while, and in some rollouts nothing else.
  SampleCommands sideways() const {
    SampleCommands driven = *this;
    for (std::size_t i = 0; i < v.size(); ++i) {
      const double t = period * static_cast<double>(i / rollouts);
      const double phase = static_cast<double>(i % rollouts);
      driven.vy.push_back(static_cast<Scalar>(i % rollouts % 4 == 1 ? 0.0 : 0.6 * std::sin(1.3 * t + phase)));
      driven.v[i] = i % rollouts % 4 == 2 ? Scalar{0} : driven.v[i];
      driven.omega[i] = i % rollouts % 8 == 2 ? Scalar{0} : driven.omega[i];
    }
    return driven;
  }

  /// Those that a robot with this slip may be given.
  SampleCommands for_basis(const Basis& basis) const { return basis.sideways() ? sideways() : *this; }

  CommandView<Scalar> view() const {
    return {v.data(), omega.data(), 1, static_cast<std::ptrdiff_t>(rollouts), vy.empty() ? nullptr : vy.data()};
  }
  RolloutBatch<Scalar> batch(std::span<const RolloutStart> starts, std::span<const DriveCommand> past = {}) const {
    return {rollouts, periods, view(), starts, past};
  }

  /// The commands of one rollout, after those sent before the start.
  InputHistory input_history(std::size_t rollout, std::span<const DriveCommand> past) const {
    std::vector<double> t, forward, left, turn;
    if (!past.empty()) {  // what is older equals the oldest
      t.push_back(-1e3);
      forward.push_back(past.front().v);
      left.push_back(past.front().vy);
      turn.push_back(past.front().omega);
    }
    for (std::size_t i = 0; i < past.size(); ++i) {
      t.push_back(-period * static_cast<double>(past.size() - i));
      forward.push_back(past[i].v);
      left.push_back(past[i].vy);
      turn.push_back(past[i].omega);
    }
    for (std::size_t j = 0; j <= periods; ++j) {  // the last one goes on, in steps as before
      const std::size_t at = std::min(j, periods - 1) * rollouts + rollout;
      t.push_back(period * static_cast<double>(j));
      forward.push_back(static_cast<double>(v[at]));
      left.push_back(vy.empty() ? 0.0 : static_cast<double>(vy[at]));
      turn.push_back(static_cast<double>(omega[at]));
    }
    return {t, forward, left, turn};
  }
};

template <typename Scalar>
struct SamplePaths {
  std::vector<Scalar> x, y, theta;

  explicit SamplePaths(std::size_t poses) : x(poses), y(poses), theta(poses) {}
  RolloutOutputs<Scalar> outputs() {
    RolloutOutputs<Scalar> result;
    result.x = x.data();
    result.y = y.data();
    result.theta = theta.data();
    return result;
  }
  bool operator==(const SamplePaths&) const = default;
};

template <typename Scalar>
SamplePaths<Scalar> roll(const RolloutProgram& program, const RolloutBatch<Scalar>& batch,
                         const RolloutOptions& options = {}) {
  SamplePaths<Scalar> paths(batch.rollouts * batch.periods);
  rollout_batch(program, batch, paths.outputs(), options);
  return paths;
}

/// An actuator by name, with parameters for it.
struct SampleChain {
  const char* name;
  ActuatorParameters learned;
  std::vector<double> parameters;
};

inline std::vector<SampleChain> sample_chains() {
  const auto ln = [](double seconds) { return std::log(seconds); };
  return {{"none", {}, {}},
          {"lag", {.dynamics = true}, {ln(0.2), ln(0.15), ln(1e-20), ln(1e-20)}},
          {"delay of whole periods", {.dynamics = true}, {ln(1e-20), ln(1e-20), ln(0.15), ln(0.1)}},
          {"lag and delay", {.dynamics = true}, {ln(0.2), ln(0.15), ln(0.13), ln(0.07)}},
          {"clock offset", {.dynamics = true, .clock_offset = true}, {ln(0.3), ln(0.1), ln(0.131), ln(0.131), 0.02}},
          {"early poses", {.clock_offset = true}, {-0.07}},
          {"response",
           {.dynamics = true, .response = true},
           {ln(0.2), ln(0.15), ln(0.13), ln(0.07), 0.9, 1.1, 0.3, 0.2, ln(1.7), ln(1.3)}},
          {"response without delay, early poses",
           {.dynamics = true, .clock_offset = true, .response = true},
           {ln(0.2), ln(0.15), ln(1e-20), ln(1e-20), 1.1, 0.8, 0.4, 0.2, ln(1.7), ln(0.9), -0.03}},
          {"delays alone, one of them negative", {.delays = true}, {0.13, -0.02}}};
}

/// The same of drives that steer.
inline std::vector<SampleChain> steering_chains() {
  std::vector<SampleChain> chains = sample_chains();
  for (SampleChain& chain : chains) {
    chain.learned.wheelbase = 0.4;
  }
  return chains;
}

/// What a rollout knows of its drive: a speed at the start, and that any inputs may follow.
inline MeasuredActuator measured_start(const MotionModel& model, const Eigen::VectorXd& parameters) {
  return {.twist = nullptr, .until = -model.actuator(parameters).clock_offset, .any_inputs = true};
}

inline Eigen::VectorXd sample_parameters(const MotionModel& model, const SampleChain& actuator) {
  Eigen::VectorXd parameters(model.size());
  const Eigen::VectorXd slip = sample_slip(model.basis(), 31);
  parameters.head(slip.size()) = slip;
  for (std::size_t i = 0; i < actuator.parameters.size(); ++i) {
    parameters[slip.size() + static_cast<Eigen::Index>(i)] = actuator.parameters[i];
  }
  return parameters;
}

}  // namespace slipwise::tests
