// SPDX-License-Identifier: Apache-2.0
// Forward selection of limits by their profiles, then backward elimination.
#include "slipwise/estimate/limit_search.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

namespace slipwise {
namespace {

constexpr std::size_t kFewestSamples = 20;
constexpr int kMostLimits = 8;
constexpr int kShortRefinement = 4;
constexpr int kLongRefinement = 15;
constexpr double kPlateau = 4.0;  // of -2 log likelihood: a dead-band within two standard deviations
constexpr double kRateStride = 0.2;  // [s] over which measured accelerations are taken
constexpr std::array kDeadBandQuantiles{0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6};
constexpr std::array kTopQuantiles{0.5, 0.7, 0.8, 0.9, 0.95, 0.98};
constexpr std::array kRateFactors{0.3, 0.5, 0.8, 1.2, 2.0, 3.5, 6.0};
constexpr std::array kLagFactors{1.0, 0.4};  // a rate limit takes over what was taken for lag

/// Sorted sizes of what is asked of a lane and what was measured of it.
struct LaneSizes {
  std::vector<double> commands;  // not zero, distinct
  std::vector<double> speeds;
  std::vector<double> rates;
  double step = 0.0;
};

double quantile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

double in_lane(const CommandLimits& limits, int lane, const BodyTwist& twist) {
  const LanePair pair = to_lanes(limits, twist.v, twist.omega);
  return lane == 0 ? pair.first : pair.second;
}

LaneSizes lane_sizes(std::span<const DriveRecord> records, const CommandLimits& limits, int lane) {
  LaneSizes sizes;
  const int last = limits.lanes == Lanes::Sides ? 1 : lane;  // both sides share their limits
  for (int side = lane; side <= last; ++side) {
    for (const DriveRecord& record : records) {
      double before = 0.0;
      for (std::size_t i = 0; i < record.commands.size(); ++i) {
        const double command = in_lane(limits, side, record.commands.sample(i));
        sizes.step = std::max(sizes.step, std::abs(command - before));
        before = command;
        if (command != 0.0) {
          sizes.commands.push_back(std::abs(command));
        }
      }
      std::size_t from = 0;
      for (std::size_t i = 0; i < record.t.size(); ++i) {
        const double speed = in_lane(limits, side, record.wheels[i]);
        sizes.speeds.push_back(std::abs(speed));
        if (record.t[i] - record.t[from] >= kRateStride) {
          sizes.rates.push_back(std::abs(speed - in_lane(limits, side, record.wheels[from])) /
                                (record.t[i] - record.t[from]));
          from = i;
        }
      }
    }
  }
  for (auto* values : {&sizes.commands, &sizes.speeds, &sizes.rates}) {
    std::ranges::sort(*values);
  }
  const auto repeated = std::ranges::unique(sizes.commands);
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
      while (drop_idle(best)) {
      }
    }
    return best;
  }

  std::vector<FoundLimit> found(const Scored& best) const {
    const LimitedDriveFit::Spread spread = fit_.spread(best.drive);
    std::vector<FoundLimit> result;
    for (int lane = 0; lane < separate_lanes(best.drive.limits.lanes); ++lane) {
      for (std::size_t k = 0; k < kLimitKinds.size(); ++k) {
        const LimitKind kind = kLimitKinds.at(k);
        const LaneLimits limits = lane_limits(best.drive.limits, lane);
        if (!limits_anything(limits, kind)) {
          continue;
        }
        const double std = kind == LimitKind::DeadBand ? plateau_std(best, lane)
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
    for (int lane = 0; lane < separate_lanes(now.drive.limits.lanes); ++lane) {
      const LaneSizes sizes = lane_sizes(records_, now.drive.limits, lane);
      const LaneLimits limits = lane_limits(now.drive.limits, lane);
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
    return best && gain_of(*best, now) >= least_gain_ ? best : std::nullopt;
  }

  static void add(std::vector<Scored>& trials, std::optional<Scored> trial) {
    if (trial) {
      trials.push_back(*std::move(trial));
    }
  }

  /// The best of the candidates, the chain held but for its lag.
  std::optional<Scored> profile(const Scored& now, int lane, const std::vector<LimitKind>& kinds,
                                const LaneSizes& sizes) const {
    std::optional<Scored> best;
    const bool rate = kinds.front() == LimitKind::Acceleration || kinds.front() == LimitKind::Braking;
    for (const double value : candidates(kinds.front(), sizes)) {
      for (const double factor : kLagFactors) {
        LimitedDrive drive = now.drive;
        LaneLimits limits = lane_limits(drive.limits, lane);
        for (const LimitKind kind : kinds) {
          limit_of(limits, kind) = value;
        }
        set_lane_limits(drive.limits, lane, limits);
        drive.chain.lag_v *= factor;
        drive.chain.lag_omega *= factor;
        const Scored trial = scored(drive);
        if (!best || trial.loss.total < best->loss.total) {
          best = trial;
        }
        if (!rate) {
          break;
        }
      }
    }
    return best;
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
        if (top > 0.0 && top < sizes.commands.back()) {
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
  static double between(const std::vector<double>& commands, std::size_t at) {
    return 0.5 * (commands[at] + commands[at + 1]);
  }

  LimitedDrive with_dead_band(LimitedDrive drive, int lane, double value) const {
    LaneLimits limits = lane_limits(drive.limits, lane);
    limits.dead_band = value;
    set_lane_limits(drive.limits, lane, limits);
    return drive;
  }

  /// Finds every dead-band between the commands next to it, and refines the rest with it.
  Scored polished(const Scored& rough) const {
    Scored best = rough;
    for (int lane = 0; lane < separate_lanes(best.drive.limits.lanes); ++lane) {
      if (lane_limits(best.drive.limits, lane).dead_band > 0.0) {
        best = with_best_dead_band(best, lane);
      }
    }
    const Scored smooth = refined(best.drive, kLongRefinement);
    if (smooth.loss.total > best.loss.total) {
      return best;
    }
    best = smooth;
    for (int lane = 0; lane < separate_lanes(best.drive.limits.lanes); ++lane) {
      if (lane_limits(best.drive.limits, lane).dead_band > 0.0) {
        best = with_best_dead_band(best, lane);
      }
    }
    return best;
  }

  Scored with_best_dead_band(const Scored& start, int lane) const {
    const std::vector<double> commands = lane_sizes(records_, start.drive.limits, lane).commands;
    if (commands.size() < 2) {
      return start;
    }
    Scored best = start;
    const auto last = static_cast<std::ptrdiff_t>(commands.size()) - 2;
    auto centre = std::ranges::lower_bound(commands, lane_limits(start.drive.limits, lane).dead_band) -
                  commands.begin() - 1;
    for (std::ptrdiff_t stride = std::max<std::ptrdiff_t>(last / 8, 1);; stride = std::max<std::ptrdiff_t>(stride / 3, 1)) {
      std::ptrdiff_t found = centre;
      for (std::ptrdiff_t k = -3; k <= 3; ++k) {
        const std::ptrdiff_t at = std::clamp<std::ptrdiff_t>(centre + k * stride, 0, last);
        const Scored trial =
            scored(with_dead_band(start.drive, lane, between(commands, static_cast<std::size_t>(at))));
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
  /// uniform distribution.
  double plateau_std(const Scored& best, int lane) const {
    const std::vector<double> commands = lane_sizes(records_, best.drive.limits, lane).commands;
    const double value = lane_limits(best.drive.limits, lane).dead_band;
    const auto above = std::ranges::lower_bound(commands, value) - commands.begin();
    const auto alike = [&](std::ptrdiff_t at) {
      const LimitedDrive drive = with_dead_band(best.drive, lane, between(commands, static_cast<std::size_t>(at)));
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
    const double lower = low >= 0 ? commands[static_cast<std::size_t>(low)] : 0.0;
    const double upper = high < std::ssize(commands) ? commands[static_cast<std::size_t>(high)] : value;
    return std::max(upper - value, value - lower) / std::sqrt(3.0);
  }

  Scored without(const Scored& all, int lane, LimitKind kind) const {
    LimitedDrive drive = all.drive;
    LaneLimits limits = lane_limits(drive.limits, lane);
    limit_of(limits, kind) = limit_of(LaneLimits{}, kind);
    set_lane_limits(drive.limits, lane, limits);
    return refined(drive, kShortRefinement);
  }

  /// Drops the limit that gains least, if that is not enough; whether one was dropped.
  bool drop_idle(Scored& best) const {
    std::optional<Scored> idle;
    double least = least_gain_;
    for (int lane = 0; lane < separate_lanes(best.drive.limits.lanes); ++lane) {
      for (const LimitKind kind : kLimitKinds) {
        if (limits_anything(lane_limits(best.drive.limits, lane), kind)) {
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
  const LimitedDrive start = fit.start(Lanes::Channels);
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
  const LimitedDrive plain = plain_drive(fit);
  Search search(records, fit, settings.least_gain);
  Scored best = search.run(plain);
  LimitedDrive sides = plain;
  sides.limits = fit.start(Lanes::Sides).limits;
  const Scored of_sides = search.run(sides);
  if (of_sides.loss.total < best.loss.total) {
    best = of_sides;
  }
  LimitSearch result{.drive = best.drive, .found = {}, .track_std = 0.0, .reach = {}};
  if (!unlimited(best.drive.limits)) {
    result.found = search.found(best);
    result.track_std = fit.spread(best.drive).track_std;
  }
  for (int lane = 0; lane < separate_lanes(best.drive.limits.lanes); ++lane) {
    const LaneSizes sizes = lane_sizes(records, best.drive.limits, lane);
    const auto& commands = sizes.commands;
    result.reach.push_back(commands.empty() ? LaneReach{} : LaneReach{commands.front(), commands.back(), sizes.step});
  }
  return result;
}

}  // namespace slipwise
