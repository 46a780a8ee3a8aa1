// SPDX-License-Identifier: Apache-2.0
// A model predictive path integral controller: many sampled command sequences, driven through the learned model, and
// their average weighted by cost (Williams et al. 2018).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "slipwise/actuator/car_curves.hpp"
#include "slipwise/planning/coloured_noise.hpp"
#include "slipwise/rollout/rollout_batch.hpp"

namespace slipwise {

/// Limits of the sampled commands.
struct MppiLimits {
  double lowest_speed = 0.0;           ///< [m/s]
  double highest_speed = 1.0;          ///< [m/s]
  double yaw_rate = 1.0;               ///< [rad/s], to both sides
  double acceleration = 1.0;           ///< [m/s^2]
  double yaw_acceleration = 2.0;       ///< [rad/s^2]
  double sideways_speed = 0.5;         ///< [m/s], to both sides, of a robot that drives sideways
  double sideways_acceleration = 1.0;  ///< [m/s^2]
};

/// What costs how much, per second where it lasts.
struct MppiCosts {
  double across = 20.0;      ///< per squared metre beside the reference
  double along = 2.0;        ///< per squared metre ahead of or behind it
  double heading = 1.0;      ///< per squared radian off its heading
  double smoothness = 0.05;  ///< per squared change of a command, each as a fraction of its largest change
  double obstacle = 1.0;     ///< per unit of the costmap's value
  double collision = 1e4;    ///< once, where the costmap's highest value reaches `lethal`
  double lethal = 100.0;     ///< value of the costmap that counts as a collision
};

struct MppiSettings {
  std::size_t rollouts = 2048;
  std::size_t periods = 56;
  double period = 0.05;       ///< [s], as of the models
  double speed_std = 0.3;     ///< of the sampled speeds [m/s]
  double yaw_rate_std = 0.4;  ///< of the sampled yaw rates [rad/s]
  double sideways_std = 0.2;  ///< of the sampled sideways speeds [m/s]
  double colour = 0.3;        ///< time over which the noise changes [s]; 0 is white
  double temperature = 0.3;   ///< fraction of the best quarter's excess cost at which a rollout weighs e^-1
  double risk = 0.0;          ///< 0 counts the mean cost over the models, 1 the worst
  std::uint64_t seed = 1;
  MppiLimits limits = {};
  MppiCosts costs = {};

  /// \throws std::invalid_argument where a number makes no sense.
  void check() const;
};

/// Where the robot should be at the end of every period.
struct MppiReference {
  std::vector<float> x;      ///< [periods] [m]
  std::vector<float> y;      ///< [periods] [m]
  std::vector<float> theta;  ///< [periods] [rad], unwrapped near the robot's
};

/// The robot's state when a command is wanted.
struct MppiState {
  RolloutStart start;              ///< pose and drive now
  std::vector<DriveCommand> past;  ///< sent before, one period apart, the oldest first
};

struct MppiResult {
  DriveCommand command;            ///< for the next period
  std::vector<DriveCommand> plan;  ///< [periods], the commands of which it is the first
  double best_cost = 0.0;
  double effective = 0.0;  ///< rollouts that the average rests on, of all
  bool collides = false;   ///< every sampled rollout does, through some model
};

/// One number of the commands, and how it is sampled.
struct MppiAxis {
  double DriveCommand::* part;
  float spread, lowest, highest;  ///< of the samples [m/s or rad/s]
  float change;                   ///< over a period, at most
  ColouredNoise noise;
  std::vector<float> values = {};  ///< [periods * rollouts], rollouts side by side
};

class Mppi {
 public:
  /// The models differ in their parameters: the mean, and samples where risk counts. Where they drive sideways, so do
  /// the sampled commands.
  /// \throws std::invalid_argument without a model, or where one has another period than the settings or other axes
  /// than the first. With a `car`, commands are throttle (v) and steering (omega), in [-1, 1] as limits say, and go
  /// through its curves first.
  Mppi(std::vector<RolloutProgram> models, const MppiSettings& settings, std::optional<CarCurves> car = {});

  /// One iteration from the last plan, moved on by a period; at first from the last command, held. `map` is null where
  /// there are no obstacles.
  /// \throws std::invalid_argument when the reference does not fit, something is not finite, or the start is where the
  /// map is lethal.
  MppiResult step(const MppiState& state, const MppiReference& reference, const Costmap* map);
  /// Drives through other models from the next step on; the last plan stays.
  /// \throws std::invalid_argument without a model, or where one has another period than the settings.
  void adopt(std::vector<RolloutProgram> models, std::optional<CarCurves> car = {});
  /// Forgets the last plan; the next begins with this command, held.
  void reset(const DriveCommand& command);

  const MppiSettings& settings() const { return settings_; }

 private:
  void sample(const DriveCommand& last);
  void drive(const RolloutProgram& model, const MppiState& state, const MppiReference& reference, const Costmap* map);
  void add_tracking(const MppiReference& reference);
  void add_smoothness(const DriveCommand& last);
  MppiResult average();

  std::vector<RolloutProgram> models_;
  MppiSettings settings_;
  std::optional<CarCurves> car_;
  std::vector<MppiAxis> axes_;      // v, omega and, where the models have it, vy
  std::vector<DriveCommand> plan_;  // [periods]
  bool planned_ = false;
  std::vector<float> x_, y_, theta_;          // [periods * rollouts], rollouts side by side
  std::vector<float> cost_, mean_, worst_;    // [rollouts]
  std::vector<std::uint8_t> free_;            // [rollouts], whether no model collides
  std::vector<float> map_sum_, map_highest_;  // [rollouts]
};

}  // namespace slipwise
