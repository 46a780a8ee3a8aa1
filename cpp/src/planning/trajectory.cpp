// SPDX-License-Identifier: Apache-2.0
// From a goal to commands: first guesses from the table, each shaped until one reaches the goal.
#include "slipwise/planning/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "slipwise/actuator/axis_response.hpp"
#include "slipwise/actuator/first_order_lag.hpp"
#include "slipwise/lie/angle.hpp"

namespace slipwise {
namespace {

constexpr int kSettlings = 3;         // how often the time until the end is found again
constexpr double kNoTime = 1e-3;      // [s]
constexpr double kLongestPath = 1e4;  // [m]
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

/// When the last command has come through the delay [s].
double latest_delay(const ActuatorModel& actuator) { return std::max(actuator.delay_v, actuator.delay_omega); }

/// How long a channel whose lags hold `fast` and `slow` takes until it is slower than `slowest` for good [s].
double seconds_to_rest(const AxisResponse& response, double fast, double slow, double slowest) {
  const auto left = [&](double seconds) {
    return std::abs(lag_output(fast, 0.0, response.time_constant, seconds)) +
           std::abs(lag_output(slow, 0.0, response.slow_time_constant, seconds));
  };
  const double stride = response.longest_lag();
  double late = 0.0;
  while (stride > kNoTime && left(late) > slowest) {
    late += stride;
  }
  double early = std::max(0.0, late - stride);
  while (late - early > kNoTime) {
    const double middle = 0.5 * (early + late);
    (left(middle) > slowest ? early : late) = middle;
  }
  return late;
}

/// How long the last command is held, until what `at` drives with these parameters has come to rest [s].
double settling_time(const ReachProblem& at, const ManoeuvreVector& parameters, const TrajectorySettings& settings) {
  ReachProblem acts = at;
  acts.frame.settling = latest_delay(at.model.actuator());
  const ManoeuvrePath path = manoeuvre_path(acts.model, acts.frame, parameters, acts.start);
  const auto rest = [&](const AxisResponse& response, double BodyTwist::* part, double slowest) {
    return seconds_to_rest(response, path.fast.*part, path.drive.*part - path.fast.*part, slowest);
  };
  const AxisResponse speed = speed_response(at.model.actuator()), turn = yaw_rate_response(at.model.actuator());
  return acts.frame.settling +
         std::max({rest(speed, &BodyTwist::v, settings.rest_speed), rest(speed, &BodyTwist::vy, settings.rest_speed),
                   rest(turn, &BodyTwist::omega, settings.rest_yaw_rate)});
}

/// Reaches the goal, and ends there when the robot has come to rest. Where it drives on, the last command has but come
/// through the delay: the next plan finds nothing on its way to the drive but that command.
Reach reach_at_rest(ReachProblem& at, const Pose2& goal, const ManoeuvreVector& guess,
                    const TrajectorySettings& settings) {
  Reach reach = reach_goal(at, goal, guess, settings.reach);
  int linearizations = reach.linearizations;
  for (int i = 0; i < kSettlings && reach.reached && settings.end_speed == 0.0; ++i) {
    at.frame.settling = settling_time(at, reach.parameters, settings);
    reach = reach_goal(at, goal, reach.parameters, settings.reach);
    linearizations += reach.linearizations;
  }
  reach.linearizations = linearizations;
  return reach;
}

/// Whether the robot turns once more than its heading at the goal needs.
bool loops(const Reach& reach, const Pose2& goal) {
  return std::abs(reach.pose.theta - wrap_angle(goal.theta)) > std::numbers::pi;
}

/// A straight path to the goal: what a table that is sampled evenly may lack.
ManoeuvreVector straight_guess(const Pose2& goal) {
  ManoeuvreVector guess = ManoeuvreVector::Zero();
  guess[kLength] = std::hypot(goal.x, goal.y);
  return guess;
}

/// What a search came to: a reached goal counts most, then a path without a needless turn, then the gap.
bool better(const Reach& a, const Reach& b, const Pose2& goal) {
  if (a.reached != b.reached) {
    return a.reached;
  }
  if (a.reached) {
    return !loops(a, goal) && loops(b, goal);
  }
  return a.gap_xy + a.gap_yaw < b.gap_xy + b.gap_yaw;
}

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
  need(cruise >= kAtRest && cruise <= limits.speed,
       "the cruise speed must be 0.001 m/s at least, and within the limit of speed");
  need(end_speed >= 0.0 && end_speed <= cruise, "the speed at the goal must lie between 0 and the cruise speed");
  need(longest > kShortest && longest <= kLongestPath, "the longest path must lie between 0.01 and 10000 m");
  need(positive(rest_speed) && positive(rest_yaw_rate), "the speeds that count as rest must be positive");
  need(commands >= 4 && commands <= kMostCommands, "the number of commands must lie between 4 and 1000");
  need(samples > 0 && guesses > 0 && reach.iterations > 0, "samples, guesses and iterations must be positive");
  need(positive(reach.tolerance_xy) && positive(reach.tolerance_yaw) && positive(reach.turn_length),
       "tolerances must be positive");
}

TrajectoryPlanner::TrajectoryPlanner(PlanningModel model, const DriveLimits& limits, const TrajectorySettings& settings,
                                     const ActuatorState& start)
    : model_(std::move(model)),
      limits_(limits),
      settings_(checked(settings, limits)),
      table_(problem(start, settings.cruise), settings.samples) {}

ReachProblem TrajectoryPlanner::problem(const ActuatorState& start, double cruise) const {
  start.check();
  const double direction = settings_.backwards ? -1.0 : 1.0;
  const double speed = std::max(0.0, direction * start.commanded.v);
  need(speed <= limits_.speed, "the robot is commanded to drive faster at the start than the limit of speed");
  const double fastest = std::max({cruise, speed, settings_.end_speed});
  ManoeuvreFrame frame{.speeds = {.start = speed, .cruise = fastest, .end = settings_.end_speed},
                       .acceleration = limits_.acceleration,
                       .direction = direction,
                       .commands = settings_.commands};
  frame.settling = latest_delay(model_.actuator());
  const double curvature = std::min(limits_.curvature, limits_.yaw_rate / fastest);
  const double shortest = SpeedProfile::shortest(frame.speeds, frame.acceleration) + kShortest;
  ManoeuvreBounds bounds{.low = ManoeuvreVector::Constant(-curvature), .high = ManoeuvreVector::Constant(curvature)};
  bounds.low[kLength] = std::min(shortest, settings_.longest);
  bounds.high[kLength] = settings_.longest;
  if (speed > kAtRest) {  // a moving robot begins with the curvature that it is commanded to have
    bounds.low[0] = bounds.high[0] = std::clamp(start.commanded.omega / start.commanded.v, -curvature, curvature);
  }
  if (settings_.straight_end) {
    bounds.low[kCurvaturePoints - 1] = bounds.high[kCurvaturePoints - 1] = 0.0;
  }
  return {.model = model_, .frame = frame, .start = start, .bounds = bounds};
}

Trajectory TrajectoryPlanner::to(const Pose2& goal, const ActuatorState& start,
                                 const std::shared_ptr<const Ground>& ground) const {
  need(!ground || !std::holds_alternative<MeasuredTilts>(*ground), "a plan needs a plane or a map, not an attitude");
  need(goal.vector().allFinite(), "the goal is not finite; give x and y in metres and the heading in radians");
  Trajectory best{.gap_xy = std::hypot(goal.x, goal.y), .gap_yaw = std::abs(wrap_angle(goal.theta))};
  std::vector<ManoeuvreVector> guesses;
  for (const ManoeuvreTable::Entry& entry : table_.nearest(goal, settings_.guesses, settings_.reach.turn_length)) {
    guesses.push_back(entry.parameters);
  }
  guesses.insert(guesses.begin(), straight_guess(goal));
  int linearizations = 0;
  bool found = false;
  double cruise = settings_.cruise;
  for (int slower = 0; slower < kSlower; ++slower, cruise *= 0.5) {
    ReachProblem start_of_all = problem(start, cruise);
    start_of_all.frame.ground = ground;
    ManoeuvreFrame frame = start_of_all.frame;
    Reach nearest{.parameters = ManoeuvreVector::Zero()};
    bool first = true;
    for (const ManoeuvreVector& guess : guesses) {
      ReachProblem at = start_of_all;
      const Reach reach = reach_at_rest(at, goal, guess, settings_);
      linearizations += reach.linearizations;
      if (first || better(reach, nearest, goal)) {
        nearest = reach;
        frame = at.frame;
      }
      first = false;
      if (reach.reached && !loops(reach, goal)) {
        break;
      }
    }
    if (!found || nearest.reached) {
      found = true;
      best = trajectory_of(nearest, {start_of_all.model, frame, start_of_all.start, start_of_all.bounds});
    }
    // Slower commands bend more only where the yaw rate is what limits them.
    if (nearest.reached || limits_.curvature * start_of_all.frame.speeds.cruise <= limits_.yaw_rate) {
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
