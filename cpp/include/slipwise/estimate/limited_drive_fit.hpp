// SPDX-License-Identifier: Apache-2.0
// Fitting limits and chain to measured wheel speeds: a robust likelihood, its minimum near a start, and how sure that
// is.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "slipwise/actuator/command_chain.hpp"
#include "slipwise/actuator/command_limits.hpp"
#include "slipwise/estimate/prior.hpp"
#include "slipwise/linear/gauss_newton.hpp"

namespace slipwise {

/// A stretch of one run over which the commands were known without a gap: the commands, and the wheels' twist beside
/// them. The first twist is where the drive starts; only the others are explained.
struct DriveRecord {
  InputTrack commands;
  std::vector<double> t;          ///< [s], increasing, in the stamps of the commands
  std::vector<BodyTwist> wheels;  ///< [t]
};

enum class LimitKind : std::uint8_t { DeadBand, Top, Acceleration, Braking };
inline constexpr std::array kLimitKinds{LimitKind::DeadBand, LimitKind::Top, LimitKind::Acceleration,
                                        LimitKind::Braking};
double& limit_of(LaneLimits& limits, LimitKind kind);
double limit_of(const LaneLimits& limits, LimitKind kind);
/// Whether it limits anything.
bool limits_anything(const LaneLimits& limits, LimitKind kind);

/// What limits belong to: the commanded speed, the commanded yaw rate, or the two sides, which share them.
enum class LimitedAxis : std::uint8_t { Speed, YawRate, Side };
inline constexpr std::array kLanes{LimitedAxis::Speed, LimitedAxis::YawRate, LimitedAxis::Side};
LaneLimits& lane_of(CommandLimits& limits, LimitedAxis lane);
const LaneLimits& lane_of(const CommandLimits& limits, LimitedAxis lane);

/// A command as one side sees it: its speed is |gain_v * v + gain_omega * omega * track / 2|.
struct SideCommand {
  double v, omega;
};
double speed_of_side(const CommandLimits& limits, const SideCommand& command);

/// Limits and the chain behind them: delay and lag per channel. Its gain stands with the limits, in front of the sides.
struct LimitedDrive {
  CommandLimits limits;
  CommandChain chain;
  /// The fastest command that the sides' dead-band blocks and the slowest that it lets through: while track and gains
  /// are fitted, it stays between them.
  std::optional<std::array<SideCommand, 2>> edge = {};
};

/// How well a drive explains the records: -2 log likelihood of Student t residuals whose scale is the likeliest.
struct DriveLoss {
  double total;      ///< of a drive with its prior; residuals are taken as independent
  double inflation;  ///< by how much that overstates the evidence, since residuals next to each other are alike
};

struct ScoredDrive {
  LimitedDrive drive;
  DriveLoss loss;
};

/// Remembers what it was asked, since a search asks for many drives that differ in one channel, or in the chain alone.
/// So it is for one thread.
class LimitedDriveFit {
 public:
  /// `prior` is of gain, delay and lag; the track between the sides is believed near `track` [m].
  LimitedDriveFit(std::span<const DriveRecord> records, const PriorSettings& prior, double track);

  /// No limits, and the chain that is believed in before any data.
  LimitedDrive start() const;
  ScoredDrive scored(const LimitedDrive& drive) const;
  /// Over the chain and over the limits that limit anything, dead-bands held. Steps gain less and less: it stops where
  /// all that are left, if they gained as much as the last, came to no less than `wanted`.
  ScoredDrive refine(const LimitedDrive& drive, int steps,
                     double wanted = std::numeric_limits<double>::infinity()) const;
  /// Standard deviation of each smooth limit of each lane (top, acceleration, braking), robust against residuals that
  /// are alike or of unequal size; zero for what limits nothing, and for dead-bands.
  struct Spread {
    std::array<std::array<double, kLimitKinds.size()>, kLanes.size()> std;  ///< by lane and kind
    double track_std;                                                       ///< [m]
    Eigen::Matrix3d to_sides;  ///< covariance of gain of speed, gain of yaw rate and log track
  };
  Spread spread(const LimitedDrive& drive) const;

  std::size_t samples() const { return samples_; }

 private:
  /// All that a channel's loss turns on where no sides mix the two.
  struct ChannelDrive {
    LaneLimits limits;
    double gain, lag, delay;

    auto operator<=>(const ChannelDrive&) const = default;
  };
  /// One channel of a drive, and all that its loss was made of.
  struct FittedChannel {
    std::vector<InputTrack> tracks;  ///< the commands of each record that it follows
    Eigen::VectorXd error;           ///< measured less explained [samples]
    double scale;                    ///< of the errors
    Eigen::VectorXd weight;          ///< of each
    DriveLoss loss;
  };
  struct FittedDrive : ScoredDrive {
    std::array<FittedChannel, 2> channels;  ///< speed and yaw rate
  };
  /// How fast each channel's errors fall with each free parameter [samples, parameters].
  using Slopes = std::array<Eigen::MatrixXd, 2>;
  static ChannelDrive channel_drive(const LimitedDrive& drive, int c);
  /// The commands of each record that channel `c` follows.
  const std::vector<InputTrack>& tracks_of(const CommandLimits& limits, int c) const;
  /// Measured less explained in channel `c`, which follows the `tracks`.
  void put_errors(const LimitedDrive& drive, std::span<const InputTrack> tracks, int c,
                  Eigen::Ref<Eigen::VectorXd> errors) const;
  FittedChannel fitted_channel(const LimitedDrive& drive, int c) const;
  FittedDrive fitted(const LimitedDrive& drive) const;
  DriveLoss known_loss(const LimitedDrive& drive, int c) const;
  Slopes slopes(const FittedDrive& at, const std::vector<int>& free) const;
  NormalEquations equations(const FittedDrive& at, const std::vector<int>& free) const;
  double prior_loss(const LimitedDrive& drive) const;

  std::span<const DriveRecord> records_;
  PriorSettings prior_;
  double track_;
  std::size_t samples_ = 0;
  struct {
    CommandLimits limits;
    std::vector<InputTrack> tracks;
  } mutable last_;                                                  ///< asked for
  mutable std::array<std::map<ChannelDrive, DriveLoss>, 2> known_;  ///< of speed and yaw rate
};

}  // namespace slipwise
