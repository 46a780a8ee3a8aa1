// SPDX-License-Identifier: Apache-2.0
// Fitting limits and actuator to measured wheel speeds: a robust likelihood, its minimum near a start, and how sure
// that is.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "slipwise/actuator/actuator_model.hpp"
#include "slipwise/actuator/command_limits.hpp"
#include "slipwise/actuator/limit_kinds.hpp"
#include "slipwise/filter/prior.hpp"
#include "slipwise/linear/gauss_newton.hpp"

namespace slipwise {

/// A stretch of one run over which the commands were known without a gap: the commands, and the wheels' twist beside
/// them. The first twist is where the drive starts; only the others are explained.
struct WheelRecord {
  InputHistory commands;
  std::vector<double> t;          ///< [s], increasing, in the stamps of the commands
  std::vector<BodyTwist> wheels;  ///< [t]
};

double& limit_of(AxisLimits& limits, LimitKind kind);
double limit_of(const AxisLimits& limits, LimitKind kind);
/// Whether it limits anything.
bool limits_anything(const AxisLimits& limits, LimitKind kind);

/// What limits belong to: the commanded speed, the commanded yaw rate, or the two sides, which share them.
enum class LimitedAxis : std::uint8_t { Speed, YawRate, Side };
inline constexpr std::array kLimitedAxes{LimitedAxis::Speed, LimitedAxis::YawRate, LimitedAxis::Side};
AxisLimits& axis_of(CommandLimits& limits, LimitedAxis axis);
const AxisLimits& axis_of(const CommandLimits& limits, LimitedAxis axis);

/// A command as one side sees it: its speed is |gain_v * v + gain_omega * omega * wheel_separation / 2|.
struct SideCommand {
  double v, omega;
};
double speed_of_side(const CommandLimits& limits, const SideCommand& command);

/// Limits and the actuator behind them: delay and lag per channel. Its gain stands with the limits, in front of the
/// sides.
struct LimitedActuator {
  CommandLimits limits;  ///< of the slew rates' lag, see `acting_limits`
  ActuatorModel actuator;
  bool rates_behind_lag = false;  ///< slew rates are of what the lag makes of the commands
  /// The fastest command that the sides' dead-band blocks and the slowest that it lets through: while wheel_separation
  /// and gains are fitted, it stays between them.
  std::optional<std::array<SideCommand, 2>> edge = {};
};

/// The limits with the lag of their slew rates, which is that of the actuator where they are behind it.
CommandLimits acting_limits(const LimitedActuator& drive);

/// How well a drive explains the records: -2 log likelihood of Student t residuals whose scale is the likeliest.
struct ActuatorLoss {
  double total;      ///< of a drive with its prior; residuals are taken as independent
  double inflation;  ///< by how much that overstates the evidence, since residuals next to each other are alike
};

struct ScoredActuator {
  LimitedActuator drive;
  ActuatorLoss loss;
};

/// Remembers what it was asked, since a search asks for many drives that differ in one channel, or in the actuator
/// alone. So it is for one thread.
class LimitedActuatorFit {
 public:
  /// `prior` is of gain, delay and lag; the separation of the sides is near `wheel_separation` [m].
  LimitedActuatorFit(std::span<const WheelRecord> records, const PriorSettings& prior, double wheel_separation);

  /// No limits, and the actuator of the prior.
  LimitedActuator start() const;
  ScoredActuator scored(const LimitedActuator& drive) const;
  /// Over the actuator and over the limits that limit anything, dead-bands held. Steps gain less and less: it stops
  /// where all that are left, if they gained as much as the last, came to no less than `wanted`, or where one gained
  /// less than `least_gain` of -2 log likelihood.
  ScoredActuator refine(const LimitedActuator& drive, int steps,
                        double wanted = std::numeric_limits<double>::infinity(), double least_gain = 0.1) const;
  /// Standard deviation of each smooth limit of each axis (saturation, slew rates), robust against residuals
  /// that are alike or of unequal size; zero for what limits nothing, and for dead-bands.
  struct Spread {
    std::array<std::array<double, kLimitKinds.size()>, kLimitedAxes.size()> std;  ///< by axis and kind
    std::array<double, 2> lag_std;                                                ///< [s] of speed and yaw rate
    double wheel_separation_std;                                                  ///< [m]
    Eigen::Matrix3d to_sides;  ///< covariance of gain of speed, gain of yaw rate and log separation
  };
  Spread spread(const LimitedActuator& drive) const;

  std::size_t samples() const { return samples_; }

 private:
  /// All that a channel's loss turns on where no sides mix the two.
  struct AxisActuator {
    AxisLimits limits;
    double gain, lag, delay;

    auto operator<=>(const AxisActuator&) const = default;
  };
  /// One channel of a drive, and all that its loss was made of.
  struct FittedChannel {
    std::vector<InputHistory> inputs;  ///< the commands of each record that it follows
    Eigen::VectorXd error;             ///< measured less explained [samples]
    double scale;                      ///< of the errors
    Eigen::VectorXd weight;            ///< of each
    ActuatorLoss loss;
  };
  struct FittedActuator : ScoredActuator {
    std::array<FittedChannel, 2> channels;  ///< speed and yaw rate
  };
  /// How fast each channel's errors fall with each free parameter [samples, parameters].
  using Slopes = std::array<Eigen::MatrixXd, 2>;
  static AxisActuator channel_drive(const LimitedActuator& drive, int c);
  /// The commands of each record that channel `c` follows, behind limits that act.
  const std::vector<InputHistory>& inputs_of(const CommandLimits& limits, int c) const;
  /// Measured less explained in channel `c`, which follows the `inputs`.
  void put_errors(const LimitedActuator& drive, std::span<const InputHistory> inputs, int c,
                  Eigen::Ref<Eigen::VectorXd> errors) const;
  FittedChannel fitted_channel(const LimitedActuator& drive, int c) const;
  FittedActuator fitted(const LimitedActuator& drive) const;
  ActuatorLoss known_loss(const LimitedActuator& drive, int c) const;
  Slopes derivatives(const FittedActuator& at, const std::vector<int>& free) const;
  NormalEquations equations(const FittedActuator& at, const std::vector<int>& free) const;
  double prior_loss(const LimitedActuator& drive) const;

  std::span<const WheelRecord> records_;
  PriorSettings prior_;
  double wheel_separation_;
  std::size_t samples_ = 0;
  struct {
    CommandLimits limits;
    std::vector<InputHistory> inputs;
  } mutable last_;                                                     ///< asked for
  mutable std::array<std::map<AxisActuator, ActuatorLoss>, 2> known_;  ///< of speed and yaw rate
};

}  // namespace slipwise
