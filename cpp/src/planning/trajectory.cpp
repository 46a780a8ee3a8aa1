// SPDX-License-Identifier: Apache-2.0
// From a goal to commands: first guesses from the table, each shaped until one reaches the goal.
#include "slipwise/planning/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace slipwise {
namespace {

constexpr double kSettledLags = 5.0;  // time constants until a lag has come to rest (e^-5)
constexpr double kAtRest = 1e-3;      // [m/s]
constexpr double kShortest = 1e-2;    // [m] of a commanded path
constexpr int kMostCommands = 1000;
constexpr int kSlower = 3;  // cruise speeds tried, each half of the one before

void need(bool fine, const char* fault) {
  if (!fine) {
    throw std::invalid_argument(fault);
  }
}

bool positive(double value) { return value > 0.0 && std::isfinite(value); }

/// How long the last command is held: until it has come through the delay, and at rest through the lag too. Then the
/// next plan finds nothing on its way to the drive but that command.
double settling_time(const CommandChain& chain, double end_speed) {
  const double lags = end_speed > 0.0 ? 0.0 : kSettledLags;
  return std::max(chain.delay_v, chain.delay_omega) +
         lags * std::max({chain.lag_v, chain.lag_omega, chain.slow_lag_v, chain.slow_lag_omega});
}

/// Whether attempt `a` came nearer to the goal than `b`.
bool nearer(const Reach& a, const Reach& b) { return a.gap_xy + a.gap_yaw < b.gap_xy + b.gap_yaw; }

Trajectory trajectory_of(const Reach& reach, const ReachProblem& at) {
  const HeldCommands held = held_commands(at.frame, reach.parameters);
  Trajectory result{.status = reach.reached ? TrajectoryStatus::Reached : TrajectoryStatus::Unreachable};
  for (std::size_t k = 0; k < held.commands.size(); ++k) {
    result.t.push_back(static_cast<double>(k) * held.period.value);
    result.v.push_back(held.commands[k].v);
    result.omega.push_back(held.commands[k].omega);
  }
  result.path = manoeuvre_path(at.model, at.frame, reach.parameters, at.start);
  result.gap_xy = reach.gap_xy;
  result.gap_yaw = reach.gap_yaw;
  return result;
}

TrajectorySettings checked(const TrajectorySettings& settings, const DriveLimits& limits) {
  limits.check();
  settings.check(limits);
  return settings;
}

}  // namespace

std::string_view advice(TrajectoryStatus status) {
  switch (status) {
    case TrajectoryStatus::Reached:
      return "the goal is reached";
    case TrajectoryStatus::TooFar:
      return "the goal is farther than the longest path: choose a nearer goal, or allow a longer path";
    case TrajectoryStatus::Unreachable:
      return "no manoeuvre within the limits ends at the goal: allow a larger curvature or yaw rate, a longer path, or "
             "the other direction";
  }
  return "";
}

void TrajectorySettings::check(const DriveLimits& limits) const {
  need(positive(cruise) && cruise <= limits.speed, "the cruise speed must be positive and within the limit of speed");
  need(end_speed >= 0.0 && end_speed <= cruise, "the speed at the goal must lie between 0 and the cruise speed");
  need(positive(longest) && longest > kShortest, "the longest path must be positive metres");
  need(commands >= 4 && commands <= kMostCommands, "the number of commands must lie between 4 and 1000");
  need(samples > 0 && guesses > 0 && reach.iterations > 0, "samples, guesses and iterations must be positive");
  need(positive(reach.tolerance_xy) && positive(reach.tolerance_yaw) && positive(reach.turn_length),
       "tolerances must be positive");
}

TrajectoryPlanner::TrajectoryPlanner(PlanningModel model, const DriveLimits& limits, const TrajectorySettings& settings,
                                     const DriveStart& start)
    : model_(std::move(model)),
      limits_(limits),
      settings_(checked(settings, limits)),
      table_(problem(start, settings.cruise), settings.samples) {}

ReachProblem TrajectoryPlanner::problem(const DriveStart& start, double cruise) const {
  start.check();
  const double direction = settings_.backwards ? -1.0 : 1.0;
  const double speed = std::max(0.0, direction * start.told.v);
  need(speed <= limits_.speed, "the robot is told to drive faster at the start than the limit of speed");
  const double fastest = std::max({cruise, speed, settings_.end_speed});
  ManoeuvreFrame frame{.speeds = {.start = speed, .cruise = fastest, .end = settings_.end_speed},
                       .acceleration = limits_.acceleration,
                       .direction = direction,
                       .commands = settings_.commands};
  frame.settling = settling_time(model_.chain(), settings_.end_speed);
  const double curvature = std::min(limits_.curvature, limits_.yaw_rate / fastest);
  const double shortest = SpeedProfile::shortest(frame.speeds, frame.acceleration) + kShortest;
  ManoeuvreBounds bounds{.low = ManoeuvreVector::Constant(-curvature), .high = ManoeuvreVector::Constant(curvature)};
  bounds.low[kLength] = std::min(shortest, settings_.longest);
  bounds.high[kLength] = settings_.longest;
  if (speed > kAtRest) {  // a moving robot begins with the curvature that it is told to have
    bounds.low[0] = bounds.high[0] = std::clamp(start.told.omega / start.told.v, -curvature, curvature);
  }
  if (settings_.straight_end) {
    bounds.low[kCurvaturePoints - 1] = bounds.high[kCurvaturePoints - 1] = 0.0;
  }
  return {.model = model_, .frame = frame, .start = start, .bounds = bounds};
}

Trajectory TrajectoryPlanner::to(const Pose2& goal, const DriveStart& start) const {
  need(goal.vector().allFinite(), "the goal is not finite; give x and y in metres and the heading in radians");
  Trajectory best{.gap_xy = std::hypot(goal.x, goal.y), .gap_yaw = std::abs(wrap_angle(goal.theta))};
  const auto guesses = table_.nearest(goal, settings_.guesses, settings_.reach.turn_length);
  int linearizations = 0;
  bool any = false;
  double cruise = settings_.cruise;
  for (int slower = 0; slower < kSlower; ++slower, cruise *= 0.5) {
    const ReachProblem at = problem(start, cruise);
    Reach nearest{.parameters = ManoeuvreVector::Zero()};
    for (std::size_t i = 0; i < guesses.size(); ++i) {
      const Reach reach = reach_goal(at, goal, guesses[i].parameters, settings_.reach);
      linearizations += reach.linearizations;
      if (i == 0 || nearer(reach, nearest)) {
        nearest = reach;
      }
      if (reach.reached) {
        break;
      }
    }
    if (!guesses.empty() && (!any || nearest.reached)) {
      best = trajectory_of(nearest, at);
      any = true;
    }
    // Slower commands bend more only where the yaw rate is what limits them.
    if (nearest.reached || limits_.curvature * at.frame.speeds.cruise <= limits_.yaw_rate) {
      break;
    }
  }
  best.linearizations = linearizations;
  if (best.status != TrajectoryStatus::Reached && std::hypot(goal.x, goal.y) > settings_.longest) {
    best.status = TrajectoryStatus::TooFar;
  }
  return best;
}

}  // namespace slipwise
