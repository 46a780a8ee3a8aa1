// SPDX-License-Identifier: Apache-2.0
// Success and time of trajectories to goals that are reachable: the ends of random admissible manoeuvres.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "slipwise/planning/trajectory.hpp"
#include "slipwise/slip/slip_surface.hpp"

namespace {

using namespace slipwise;  // NOLINT(google-build-using-namespace)

constexpr unsigned kSeed = 20261121;
constexpr double kTolerance = 1e-3;

struct Case {
  std::string name;
  MotionModel model;
  Eigen::VectorXd parameters;
  double end_speed;
};

Case make_case(const std::string& name, const std::string& basis, bool dynamics, double end_speed) {
  MotionModel model(named_basis(basis), {.dynamics = dynamics});
  Eigen::VectorXd parameters = Eigen::VectorXd::Constant(model.size(), 0.02);
  const auto set = [&](const std::string& wanted, double value) {
    for (std::size_t i = 0; i < model.basis().size(); ++i) {
      if (model.basis().parameter_name(i) == wanted) {
        parameters[static_cast<Eigen::Index>(i)] = value;
      }
    }
  };
  set("lon.V", -0.08);
  set("ang.w", -0.35);
  set("ang.kappa*V", -0.3);
  set("lat.V*w", 0.05);
  if (dynamics) {
    parameters.tail(4) << std::log(0.4), std::log(0.3), std::log(0.16), std::log(0.12);
  }
  return {name, model, parameters, end_speed};
}

/// Commands whose curvature is linear between twelve random values: shapes that manoeuvres do not have.
Pose2 foreign_goal(const PlanningModel& model, const ReachProblem& problem, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const double top = problem.bounds.high[1];
  const double low = problem.bounds.low[kLength], high = problem.bounds.high[kLength];
  const SpeedProfile profile(problem.frame.speeds, problem.frame.acceleration, low + (high - low) * uniform(random));
  std::vector<double> bends;
  for (int i = 0; i < 12; ++i) {
    bends.push_back(top * std::clamp(4.0 * uniform(random) - 2.0, -1.0, 1.0));  // half of them at the limit
  }
  constexpr int kCommands = 64;
  const double period = profile.duration().value / kCommands;
  std::vector<double> t{-1e3}, v{0.0}, vy{0.0}, omega{0.0};
  for (int k = 0; k <= kCommands; ++k) {
    const double along = 11.0 * std::min((k + 0.5) / kCommands, 0.999);
    const auto i = static_cast<std::size_t>(along);
    const double bend = bends[i] + (along - static_cast<double>(i)) * (bends[i + 1] - bends[i]);
    const double speed = k == kCommands ? problem.frame.speeds.end
                                        : (profile.distance((k + 1.0) / kCommands).value -
                                           profile.distance(static_cast<double>(k) / kCommands).value) /
                                              period;
    t.push_back(k * period);
    v.push_back(speed);
    vy.push_back(0.0);
    omega.push_back(bend * speed);
  }
  const ActuatorSpan window{.start = 0.0, .end = kCommands * period + problem.frame.settling, .initial = BodyTwist{}};
  Pose2 pose;
  for (const ActuatorStep& step : actuator_steps(InputHistory(t, v, vy, omega), model.actuator(), window).steps) {
    const double rate = step.duration > 0.0 ? 1.0 / step.duration : 0.0;
    const SlipState state{.v = step.forward * rate, .omega = step.turn * rate};
    const Eigen::Vector3d slip = slip_rate(model.basis(), model.alpha(), state);
    pose = compose(pose, exp(Eigen::Vector3d(step.forward, step.left, step.turn) + slip * step.duration));
  }
  return pose;
}

Pose2 own_goal(const PlanningModel& model, const ReachProblem& problem, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  ManoeuvreVector parameters;
  for (int i = 0; i < kManoeuvreParameters; ++i) {
    parameters[i] = problem.bounds.low[i] + (problem.bounds.high[i] - problem.bounds.low[i]) * uniform(random);
  }
  return manoeuvre_pose(model, problem.frame, parameters, problem.start);
}

/// Plans to `count` goals; returns the fraction reached.
double report(const Case& chosen, bool foreign, int count) {
  const PlanningModel model(chosen.model, chosen.parameters);
  const DriveLimits limits{.speed = 1.5, .yaw_rate = 1.0, .curvature = 0.8, .acceleration = 0.8};
  TrajectorySettings settings{.cruise = 1.2, .end_speed = chosen.end_speed, .longest = 10.0};
  settings.reach.tolerance_xy = settings.reach.tolerance_yaw = kTolerance;
  const auto begin = std::chrono::steady_clock::now();
  const TrajectoryPlanner planner(model, limits, settings);
  const double table = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const ReachProblem problem = planner.problem(ActuatorState{}, settings.cruise);
  std::mt19937_64 random(kSeed);
  std::vector<double> times;
  double linearizations = 0.0;
  int reached = 0;
  for (int i = 0; i < count; ++i) {
    const Pose2 goal = foreign ? foreign_goal(model, problem, random) : own_goal(model, problem, random);
    const auto start = std::chrono::steady_clock::now();
    const Trajectory trajectory = planner.to(goal, ActuatorState{});
    times.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
    reached += trajectory.status == TrajectoryStatus::Reached ? 1 : 0;
    linearizations += trajectory.linearizations;
  }
  std::ranges::sort(times);
  const auto at = [&](double fraction) { return times[static_cast<std::size_t>(fraction * (count - 1))]; };
  const double success = static_cast<double>(reached) / count;
  std::printf("%-34s %-9s %8.2f %% %9.1f %9.1f %9.1f %9.2f %9.2f\n", chosen.name.c_str(), foreign ? "foreign" : "own",
              100.0 * success, at(0.5), at(0.95), at(0.99), linearizations / count, table);
  return success;
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? static_cast<int>(std::strtol(argv[1], nullptr, 10)) : 10000;
  std::printf("Trajectories to %d reachable goals, tolerance 1 mm and 1 mrad, from rest, up to 10 m at 1.2 m/s\n",
              count);
  std::printf("%-34s %-9s %10s %9s %9s %9s %9s %9s\n", "model, end", "goals", "reached", "median us", "95 % us",
              "99 % us", "lineariz.", "table s");
  for (const Case& chosen :
       {make_case("edd-2, passing", "edd-2", false, 0.6), make_case("odd-even-10, passing", "odd-even-10", false, 0.6),
        make_case("thesis-15, passing", "thesis-15", false, 0.6),
        make_case("odd-even-10 with actuator, passing", "odd-even-10", true, 0.6),
        make_case("odd-even-10 with actuator, at rest", "odd-even-10", true, 0.0)}) {
    report(chosen, false, count);
    report(chosen, true, count);
  }
  return 0;
}
