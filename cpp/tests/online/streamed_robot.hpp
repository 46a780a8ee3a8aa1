// SPDX-License-Identifier: Apache-2.0
// A robot that drives, slips and lags, as streams of measurements with seeded noise.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "slipwise/online/motion_learner.hpp"
#include "slipwise/online/recording.hpp"

namespace slipwise::tests {

/// Commands at 20 Hz, wheel speeds at 20 Hz behind a lag of 0.3 s, poses at 10 Hz; the robot turns a third less than
/// its wheels. Stamps of the streams differ.
inline Recording streamed_robot(std::uint64_t seed, double seconds, double begin = 100.0) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> speed(0.2, 1.2), yaw_rate(-0.8, 0.8);
  std::normal_distribution<double> normal;
  Recording run;
  BodyTwist command{};
  BodyTwist wheels{};
  Pose2 pose;
  constexpr double kStep = 0.05;
  const auto steps = static_cast<int>(seconds / kStep);
  for (int i = 0; i < steps; ++i) {
    const double t = begin + kStep * i;
    if (i % 40 == 0) {
      command = {speed(random), 0.0, yaw_rate(random)};
    }
    run.commands.push_back({t, command});
    wheels.v += (command.v - wheels.v) * kStep / 0.3;
    wheels.omega += (command.omega - wheels.omega) * kStep / 0.3;
    run.wheels.push_back({t + 0.013, {wheels.v + 0.01 * normal(random), 0.0, wheels.omega + 0.01 * normal(random)}});
    pose = compose(pose, exp(Eigen::Vector3d(wheels.v * kStep, 0.0, wheels.omega / 1.5 * kStep)));
    if (i % 2 == 0) {
      run.poses.push_back({.t = t + 0.031,
                           .x = pose.x + 0.005 * normal(random),
                           .y = pose.y + 0.005 * normal(random),
                           .yaw = std::remainder(pose.theta + 0.003 * normal(random), 6.283185307179586)});
    }
  }
  return run;
}

inline LearnerSettings learner_settings(bool from_commands) {
  LearnerSettings settings;
  settings.stream.from_commands = from_commands;
  settings.stream.segment_length = from_commands ? 2.5 : 1.0;
  settings.hypotheses.bases = {{"none", {}, {}, {}}, named_basis("edd-2"), named_basis("full-linear-6")};
  settings.hypotheses.dynamics = from_commands;
  return settings;
}

/// A measurement of a run, and when it arrives.
struct Arrival {
  double at;   ///< [s]
  int stream;  ///< 0: commands, 1: wheels, 2: poses
  std::size_t place;
};

/// Pushes measurements of a run in the order of arrival; `arrived` is called with each time.
template <class Arrived>
void push_arrivals(MotionLearner& learner, const Recording& run, std::vector<Arrival> arrivals,
                   const Arrived& arrived) {
  std::ranges::stable_sort(arrivals, {}, &Arrival::at);
  for (const auto& [at, stream, i] : arrivals) {
    if (stream == 0) {
      learner.push(CommandSample{{run.commands[i].t, run.commands[i].twist}});
    } else if (stream == 1) {
      learner.push(WheelSample{{run.wheels[i].t, run.wheels[i].twist}});
    } else {
      learner.push(run.poses[i]);
    }
    arrived(at);
  }
}

/// Pushes a run with each stream late by its own random time of up to `latest`, in the order of arrival.
inline void push_late(MotionLearner& learner, const Recording& run, double latest, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> late(0.0, latest);
  std::vector<Arrival> arrivals;
  const auto add = [&](int stream, const auto& samples) {
    double before = -1e300;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      before = std::max(before, samples[i].t + late(random));  // each stream stays in order
      arrivals.push_back({before, stream, i});
    }
  };
  add(0, run.commands);
  add(1, run.wheels);
  add(2, run.poses);
  push_arrivals(learner, run, std::move(arrivals), [](double /*at*/) {});
}

}  // namespace slipwise::tests
