// SPDX-License-Identifier: Apache-2.0
// Forward selection of limits by their profiles, then backward elimination.
#include "slipwise/estimate/limit_search.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace slipwise {
namespace {

constexpr std::size_t kFewestSamples = 20;
constexpr int kMostLimits = 8;
constexpr int kShortRefinement = 4;
constexpr int kLongRefinement = 15;
constexpr double kWorthMoving = 2.0;  // of -2 log likelihood
constexpr double kNear = 0.1;         // of a dead-band; which commands it blocks may turn on what they ask for
constexpr double kHopeless = 50.0;    // the same; polishing does not gain as much
constexpr double kPlateau = 4.0;      // of -2 log likelihood: a dead-band within two standard deviations
constexpr double kRateStride = 0.2;   // [s] over which measured accelerations are taken
constexpr std::array kDeadBandQuantiles{0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6};
constexpr std::array kTopQuantiles{0.5, 0.7, 0.8, 0.9, 0.95, 0.98};
constexpr std::array kRateFactors{0.3, 0.5, 0.8, 1.2, 2.0, 3.5, 6.0};
constexpr double kLagFactor = 0.4;

/// A command in a lane.
struct Asked {
  double speed;
  SideCommand of_side;  // of the sides alone
};

/// Sorted sizes of what is asked of a lane and what was measured of it.
struct LaneSizes {
  std::vector<Asked> commands;  // not zero, distinct
  std::vector<double> speeds;
  std::vector<double> rates;
  double step = 0.0;
};

double quantile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

/// A twist in a lane: once, or once for each side.
std::array<double, 2> in_lane(const CommandLimits& limits, Lane lane, const BodyTwist& twist) {
  if (lane == Lane::Side) {
    const SideSpeeds sides = side_speeds(limits, twist);
    return {sides.left, sides.right};
  }
  const double one = lane == Lane::Speed ? twist.v : twist.omega;
  return {one, one};
}

/// Wheels have passed all gains.
CommandLimits of_wheels(const CommandLimits& limits) { return {.track = limits.track}; }

void add_commands(LaneSizes& sizes, const CommandLimits& limits, Lane lane, const InputTrack& commands) {
  std::array<double, 2> before{};
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const BodyTwist twist = commands.sample(i);
    const std::array<double, 2> now = in_lane(limits, lane, twist);
    for (std::size_t side = 0; side < now.size(); ++side) {
      sizes.step = std::max(sizes.step, std::abs(now.at(side) - before.at(side)));
      if (now.at(side) != 0.0) {
        sizes.commands.push_back({std::abs(now.at(side)), {twist.v, side == 0 ? -twist.omega : twist.omega}});
      }
    }
    before = now;
  }
}

void add_wheels(LaneSizes& sizes, const CommandLimits& limits, Lane lane, const DriveRecord& record) {
  std::size_t from = 0;
  for (std::size_t i = 0; i < record.t.size(); ++i) {
    const double seconds = record.t[i] - record.t[from];
    const std::array<double, 2> now = in_lane(limits, lane, record.wheels[i]);
    const std::array<double, 2> before = in_lane(limits, lane, record.wheels[from]);
    for (std::size_t side = 0; side < now.size(); ++side) {
      sizes.speeds.push_back(std::abs(now.at(side)));
      if (seconds >= kRateStride) {
        sizes.rates.push_back(std::abs(now.at(side) - before.at(side)) / seconds);
      }
    }
    from = seconds >= kRateStride ? i : from;
  }
}

LaneSizes lane_sizes(std::span<const DriveRecord> records, const CommandLimits& limits, Lane lane) {
  LaneSizes sizes;
  for (const DriveRecord& record : records) {
    const bool behind = lane == Lane::Side && !unlimited(channel_limits(limits));
    add_commands(sizes, limits, lane,
                 behind ? limited_track(record.commands, channel_limits(limits)) : record.commands);
    add_wheels(sizes, of_wheels(limits), lane, record);
  }
  std::ranges::sort(sizes.commands, {}, &Asked::speed);
  std::ranges::sort(sizes.speeds);
  std::ranges::sort(sizes.rates);
  const auto repeated = std::ranges::unique(sizes.commands, {}, &Asked::speed);
  sizes.commands.erase(repeated.begin(), repeated.end());
  return sizes;
}

struct Scored {
  LimitedDrive drive;
  DriveLoss loss;
};

double gain_of(const Scored& more, const Scored& less) {
  return (less.loss.total - more.loss.total) / more.loss.inflation;
}

/// The search over one kind of lanes.
class Search {
 public:
  Search(std::span<const DriveRecord> records, const LimitedDriveFit& fit, double least_gain)
      : records_(records), fit_(fit), least_gain_(least_gain) {}

  Scored run(const LimitedDrive& plain) {
    Scored best = scored(plain);
    for (int i = 0; i < kMostLimits; ++i) {
      const std::optional<Scored> next = with_one_more(best);
      if (!next) {
        break;
      }
      best = *next;
    }
    if (!unlimited(best.drive.limits)) {
      best = polished(best);
      while (drop_idle(best) || move_one(best)) {
      }
    }
    return best;
  }

  std::vector<FoundLimit> found(const Scored& best) const {
    const LimitedDriveFit::Spread spread = fit_.spread(best.drive);
    std::vector<FoundLimit> result;
    for (const Lane lane : kLanes) {
      for (std::size_t k = 0; k < kLimitKinds.size(); ++k) {
        const LimitKind kind = kLimitKinds.at(k);
        const LaneLimits& limits = lane_of(best.drive.limits, lane);
        if (!limits_anything(limits, kind)) {
          continue;
        }
        const double std = kind == LimitKind::DeadBand ? dead_band_std(best, lane, spread.to_sides)
                                                       : spread.std.at(static_cast<std::size_t>(lane)).at(k);
        result.push_back({lane, kind, limit_of(limits, kind), std, gain_of(best, without(best, lane, kind))});
      }
    }
    return result;
  }

 private:
  Scored scored(const LimitedDrive& drive) const { return {drive, fit_.loss(drive)}; }

  Scored refined(const LimitedDrive& drive, int iterations) const { return scored(fit_.refine(drive, iterations)); }

  /// The best limit, or pair of rates, to add; nothing where none gains enough.
  std::optional<Scored> with_one_more(const Scored& now) const {
    std::vector<Scored> trials;
    for (const Lane lane : kLanes) {
      const LaneSizes sizes = lane_sizes(records_, now.drive.limits, lane);
      const LaneLimits& limits = lane_of(now.drive.limits, lane);
      for (const LimitKind kind : kLimitKinds) {
        if (!limits_anything(limits, kind)) {
          add(trials, profile(now, lane, {kind}, sizes));
        }
      }
      if (!limits_anything(limits, LimitKind::Acceleration) && !limits_anything(limits, LimitKind::Braking)) {
        add(trials, profile(now, lane, {LimitKind::Acceleration, LimitKind::Braking}, sizes));
      }
    }
    std::ranges::sort(trials, {}, [](const Scored& trial) { return trial.loss.total; });
    std::optional<Scored> best;
    for (std::size_t i = 0; i < std::min<std::size_t>(trials.size(), 3); ++i) {
      const Scored trial = refined(trials[i].drive, kShortRefinement);
      if (!best || trial.loss.total < best->loss.total) {
        best = trial;
      }
    }
    // While others are missing, residuals are alike; whether it gains enough is judged once all are found.
    return best && now.loss.total - best->loss.total >= 2.0 * least_gain_ ? best : std::nullopt;
  }

  static void add(std::vector<Scored>& trials, std::optional<Scored> trial) {
    if (trial) {
      trials.push_back(*std::move(trial));
    }
  }

  /// The best of the candidates, the chain held but for what took the limit's place: lag that of a rate, gain that of
  /// a top.
  std::optional<Scored> profile(const Scored& now, Lane lane, const std::vector<LimitKind>& kinds,
                                const LaneSizes& sizes) const {
    std::optional<Scored> best;
    for (const double value : candidates(kinds.front(), sizes)) {
      LimitedDrive drive = now.drive;
      for (const LimitKind kind : kinds) {
        limit_of(lane_of(drive.limits, lane), kind) = value;
      }
      if (lane == Lane::Side && kinds.front() == LimitKind::DeadBand) {
        set_edge(drive, sizes.commands);
      }
      for (const LimitedDrive& candidate : beside(kinds.front(), drive)) {
        const Scored trial = scored(candidate);
        if (!best || trial.loss.total < best->loss.total) {
          best = trial;
        }
      }
    }
    return best;
  }

  static std::vector<LimitedDrive> beside(LimitKind kind, const LimitedDrive& drive) {
    LimitedDrive other = drive;
    if (kind == LimitKind::Acceleration || kind == LimitKind::Braking) {
      other.chain.lag_v *= kLagFactor;
      other.chain.lag_omega *= kLagFactor;
      return {drive, other};
    }
    if (kind == LimitKind::Top) {
      other.limits.gain_v = other.limits.gain_omega = 1.0;
      return {drive, other};
    }
    return {drive};
  }

  static std::vector<double> candidates(LimitKind kind, const LaneSizes& sizes) {
    std::vector<double> values;
    if (sizes.commands.size() < 2 || sizes.speeds.empty() || sizes.rates.empty()) {
      return values;
    }
    if (kind == LimitKind::DeadBand) {
      for (const double share : kDeadBandQuantiles) {
        const auto at = static_cast<std::size_t>(share * static_cast<double>(sizes.commands.size() - 2));
        values.push_back(between(sizes.commands, at));
      }
    } else if (kind == LimitKind::Top) {
      for (const double share : kTopQuantiles) {
        const double top = quantile(sizes.speeds, share);
        if (top > 0.0 && top < sizes.commands.back().speed) {
          values.push_back(top);
        }
      }
    } else if (const double usual = quantile(sizes.rates, 0.9); usual > 0.0) {
      for (const double factor : kRateFactors) {
        values.push_back(factor * usual);
      }
    }
    return values;
  }

  /// A dead-band that blocks command `at` and no larger one.
  static double between(const std::vector<Asked>& commands, std::size_t at) {
    return 0.5 * (commands[at].speed + commands[at + 1].speed);
  }

  /// Remembers between which commands the sides' dead-band lies.
  static void set_edge(LimitedDrive& drive, const std::vector<Asked>& commands) {
    const auto passed = std::ranges::lower_bound(commands, drive.limits.side.dead_band, {}, &Asked::speed);
    drive.edge.reset();
    if (passed != commands.begin() && passed != commands.end()) {
      drive.edge = {std::prev(passed)->of_side, passed->of_side};
    }
  }

  static LimitedDrive with_dead_band(LimitedDrive drive, Lane lane, const std::vector<Asked>& commands,
                                     std::ptrdiff_t at) {
    lane_of(drive.limits, lane).dead_band = between(commands, static_cast<std::size_t>(at));
    if (lane == Lane::Side) {
      set_edge(drive, commands);
    }
    return drive;
  }

  /// Finds every dead-band between the commands next to it, and refines the rest with it.
  Scored polished(const Scored& rough) const {
    Scored best = rough;
    for (const Lane lane : kLanes) {
      if (lane_of(best.drive.limits, lane).dead_band > 0.0) {
        best = with_best_dead_band(best, lane);
      }
    }
    const Scored smooth = refined(best.drive, kLongRefinement);
    if (smooth.loss.total > best.loss.total) {
      return best;
    }
    best = smooth;
    for (const Lane lane : kLanes) {
      if (lane_of(best.drive.limits, lane).dead_band > 0.0) {
        best = with_best_dead_band(best, lane);
      }
    }
    return best;
  }

  Scored with_best_dead_band(const Scored& start, Lane lane) const {
    const std::vector<Asked> commands = lane_sizes(records_, start.drive.limits, lane).commands;
    if (commands.size() < 2) {
      return start;
    }
    Scored best = start;
    const auto last = static_cast<std::ptrdiff_t>(commands.size()) - 2;
    auto centre = std::ranges::lower_bound(commands, lane_of(start.drive.limits, lane).dead_band, {}, &Asked::speed) -
                  commands.begin() - 1;
    for (std::ptrdiff_t stride = std::max<std::ptrdiff_t>(last / 8, 1);;
         stride = std::max<std::ptrdiff_t>(stride / 3, 1)) {
      std::ptrdiff_t found = centre;
      for (std::ptrdiff_t k = -3; k <= 3; ++k) {
        const std::ptrdiff_t at = std::clamp<std::ptrdiff_t>(centre + k * stride, 0, last);
        const Scored trial = scored(with_dead_band(start.drive, lane, commands, at));
        if (trial.loss.total < best.loss.total) {
          best = trial;
          found = at;
        }
      }
      centre = found;
      if (stride == 1) {
        return best;
      }
    }
  }

  /// Dead-bands between two neighbouring commands are all alike, and nearly so beyond them: half that width as of a
  /// uniform distribution. What those commands ask of the sides is not known exactly either.
  double dead_band_std(const Scored& best, Lane lane, const Eigen::Matrix3d& to_sides) const {
    const std::vector<Asked> commands = lane_sizes(records_, best.drive.limits, lane).commands;
    const double value = lane_of(best.drive.limits, lane).dead_band;
    const auto above = std::ranges::lower_bound(commands, value, {}, &Asked::speed) - commands.begin();
    const auto alike = [&](std::ptrdiff_t at) {
      const LimitedDrive drive = with_dead_band(best.drive, lane, commands, at);
      return fit_.loss(drive).total - best.loss.total < kPlateau * best.loss.inflation;
    };
    std::ptrdiff_t low = above - 1;
    std::ptrdiff_t high = above;
    while (low > 0 && alike(low - 1)) {
      --low;
    }
    while (high + 1 < std::ssize(commands) && alike(high)) {
      ++high;
    }
    const double lower = low >= 0 ? commands[static_cast<std::size_t>(low)].speed : 0.0;
    const double upper = high < std::ssize(commands) ? commands[static_cast<std::size_t>(high)].speed : value;
    const double plateau = std::max(upper - value, value - lower) / std::sqrt(3.0);
    return std::hypot(plateau, lane == Lane::Side ? side_std(best.drive.limits, lower, upper, to_sides) : 0.0);
  }

  /// How uncertain it is what the commands ask of a side that ask for about `lower` to `upper`.
  double side_std(const CommandLimits& limits, double lower, double upper, const Eigen::Matrix3d& to_sides) const {
    double variance = 0.0;
    for (const DriveRecord& record : records_) {
      const InputTrack asked = limited_track(record.commands, channel_limits(limits));
      for (std::size_t i = 0; i < asked.size(); ++i) {
        const BodyTwist twist = asked.sample(i);
        const SideSpeeds sides = side_speeds(limits, twist);
        for (const double sign : {-1.0, 1.0}) {
          const double speed = std::abs(sign < 0.0 ? sides.left : sides.right);
          if (speed > (1.0 - kNear) * lower && speed < (1.0 + kNear) * upper) {
            const double half = 0.5 * sign * twist.omega * limits.track;
            const Eigen::Vector3d slope(twist.v, half, half * limits.gain_omega);
            variance = std::max(variance, slope.dot(to_sides * slope));
          }
        }
      }
    }
    return std::sqrt(variance);
  }

  Scored without(const Scored& all, Lane lane, LimitKind kind) const {
    LimitedDrive drive = all.drive;
    limit_of(lane_of(drive.limits, lane), kind) = limit_of(LaneLimits{}, kind);
    return refined(drive, kShortRefinement);
  }

  /// Moves a limit to another lane, where it explains more; whether one was moved.
  bool move_one(Scored& best) const {
    for (const Lane from : kLanes) {
      for (const LimitKind kind : kLimitKinds) {
        if (!limits_anything(lane_of(best.drive.limits, from), kind)) {
          continue;
        }
        for (const Lane to : kLanes) {
          if (limits_anything(lane_of(best.drive.limits, to), kind)) {
            continue;
          }
          Scored rest = best;
          limit_of(lane_of(rest.drive.limits, from), kind) = limit_of(LaneLimits{}, kind);
          const std::optional<Scored> moved = profile(rest, to, {kind}, lane_sizes(records_, rest.drive.limits, to));
          if (!moved) {
            continue;
          }
          Scored trial = refined(moved->drive, kShortRefinement);
          if (trial.loss.total - best.loss.total > kHopeless) {
            continue;
          }
          trial = polished(trial);
          if (best.loss.total - trial.loss.total > kWorthMoving) {
            best = trial;
            return true;
          }
        }
      }
    }
    return false;
  }

  /// Drops the limit that gains least, if that is not enough; whether one was dropped.
  bool drop_idle(Scored& best) const {
    std::optional<Scored> idle;
    double least = least_gain_;
    for (const Lane lane : kLanes) {
      for (const LimitKind kind : kLimitKinds) {
        if (limits_anything(lane_of(best.drive.limits, lane), kind)) {
          const Scored less = without(best, lane, kind);
          if (gain_of(best, less) < least) {
            least = gain_of(best, less);
            idle = less;
          }
        }
      }
    }
    if (idle) {
      best = *idle;
    }
    return idle.has_value();
  }

  std::span<const DriveRecord> records_;
  const LimitedDriveFit& fit_;
  double least_gain_;
};

LimitedDrive plain_drive(const LimitedDriveFit& fit) {
  const LimitedDrive start = fit.start();
  LimitedDrive late = start;
  std::swap(late.chain.lag_v, late.chain.delay_v);
  std::swap(late.chain.lag_omega, late.chain.delay_omega);
  const LimitedDrive one = fit.refine(start, kLongRefinement);
  const LimitedDrive other = fit.refine(late, kLongRefinement);
  return fit.loss(one).total <= fit.loss(other).total ? one : other;
}

}  // namespace

LimitSearch find_limits(std::span<const DriveRecord> records, const PriorSettings& prior, double track,
                        const LimitSearchSettings& settings) {
  const LimitedDriveFit fit(records, prior, track);
  if (fit.samples() < kFewestSamples) {
    throw std::invalid_argument("limits need at least " + std::to_string(kFewestSamples) + " wheel twists, got " +
                                std::to_string(fit.samples()) + "; drive longer");
  }
  Search search(records, fit, settings.least_gain);
  const Scored best = search.run(plain_drive(fit));
  LimitSearch result{.drive = best.drive, .found = {}, .track_std = 0.0, .reach = {}};
  if (!unlimited(best.drive.limits)) {
    result.found = search.found(best);
    result.track_std = fit.spread(best.drive).track_std;
  }
  for (std::size_t k = 0; k < kLanes.size(); ++k) {
    const LaneSizes sizes = lane_sizes(records, best.drive.limits, kLanes.at(k));
    const auto& commands = sizes.commands;
    result.reach.at(k) =
        commands.empty() ? LaneReach{} : LaneReach{commands.front().speed, commands.back().speed, sizes.step};
  }
  CommandLimits& limits = result.drive.limits;
  if (!limits_sides(limits)) {  // the chain says the gain, and nobody needs the track
    limits.track = track;
    result.drive.chain.gain_v = std::exchange(limits.gain_v, 1.0);
    result.drive.chain.gain_omega = std::exchange(limits.gain_omega, 1.0);
  }
  return result;
}

}  // namespace slipwise
