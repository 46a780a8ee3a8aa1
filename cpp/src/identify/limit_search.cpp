// SPDX-License-Identifier: Apache-2.0
// Forward selection of limits by their profiles, then backward elimination; and elimination alone from all at once.
#include "slipwise/identify/limit_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/identify/axis_range.hpp"
#include "slipwise/identify/dead_band_search.hpp"
#include "slipwise/identify/limit_candidates.hpp"

namespace slipwise {
namespace {

constexpr std::size_t kFewestSamples = 20;
constexpr int kMostLimits = 8;
constexpr int kRounds = 3;  // of adding; what was dropped may have stood in the way
constexpr int kShortRefinement = 4;
constexpr int kLongRefinement = 15;
constexpr double kPolished = 1e-5;    // of -2 log likelihood; a hundredth of a standard deviation gains 1e-4
constexpr double kWorthMoving = 2.0;  // of -2 log likelihood
constexpr std::array kSeparationFactors{0.98, 1.02};
constexpr double kPruningBound = 50.0;  // the same; polishing does not gain as much
constexpr double kLagFactor = 0.4;
constexpr double kAnyLoss = std::numeric_limits<double>::infinity();

int count_of(const CommandLimits& limits) {
  int count = 0;
  for (const LimitedAxis axis : kLimitedAxes) {
    for (const LimitKind kind : kLimitKinds) {
      count += limits_anything(axis_of(limits, axis), kind) ? 1 : 0;
    }
  }
  return count;
}

double gain_of(const ScoredActuator& more, const ScoredActuator& less) {
  return (less.loss.total - more.loss.total) / more.loss.inflation;
}

/// The search over one kind of axes.
class Search {
 public:
  Search(std::span<const WheelRecord> records, const LimitedActuatorFit& fit, double least_gain)
      : records_(records), fit_(fit), bands_(records, fit), least_gain_(least_gain) {}

  ScoredActuator run(const LimitedActuator& start) {
    ScoredActuator best = fit_.scored(start);
    if (!unlimited(start.limits)) {
      settle_on(best);
    }
    for (int round = 0; round < kRounds; ++round) {
      const ScoredActuator before = best;
      if (!add_all(best)) {
        break;
      }
      settle_on(best);
      if (before.loss.total - best.loss.total < kWorthMoving) {  // what was added is dropped again, and would be again
        return before;
      }
    }
    return best;
  }

  /// Limits that act together may each explain too little to be added alone. So all saturations and rates of the
  /// commands are tried at once, and kept where they, or the rest of them, explain more than what was found one by
  /// one.
  ScoredActuator or_all_at_once(const ScoredActuator& one_by_one, const LimitedActuator& plain) {
    const ScoredActuator all = refined(with_all(plain), kLongRefinement, one_by_one.loss.total - least_gain_);
    if (!gains(all, one_by_one)) {
      return one_by_one;
    }
    const ScoredActuator left = run(all.drive);
    return gains(left, one_by_one) ? left : one_by_one;
  }

  /// Rates may be of the commands, or of the drive itself behind its lag: whichever explains more.
  ScoredActuator in_other_order(const ScoredActuator& best) {
    LimitedActuator drive = best.drive;
    drive.rates_behind_lag = !drive.rates_behind_lag;
    const ScoredActuator other = run(drive);
    const int more = count_of(other.drive.limits) - count_of(best.drive.limits);
    return best.loss.total - other.loss.total > kWorthMoving && gain_of(other, best) > least_gain_ * std::max(more, 0)
               ? other
               : best;
  }

  std::vector<FoundLimit> found(const ScoredActuator& best) const {
    const LimitedActuatorFit::Spread spread = fit_.spread(best.drive);
    std::vector<FoundLimit> result;
    for (const LimitedAxis axis : kLimitedAxes) {
      for (std::size_t k = 0; k < kLimitKinds.size(); ++k) {
        const LimitKind kind = kLimitKinds.at(k);
        const AxisLimits& limits = axis_of(best.drive.limits, axis);
        if (!limits_anything(limits, kind)) {
          continue;
        }
        const double std = kind == LimitKind::DeadBand ? bands_.std(best, axis, spread.to_sides)
                                                       : spread.std.at(static_cast<std::size_t>(axis)).at(k);
        result.push_back({axis, kind, limit_of(limits, kind), std, gain_of(best, without(best, axis, kind))});
      }
    }
    if (best.drive.rates_behind_lag) {
      add_lags(best, spread, result);
    }
    return result;
  }

 private:
  /// Whether `one` explains more than `other` by enough for the limits that it has more.
  bool gains(const ScoredActuator& one, const ScoredActuator& other) const {
    const int more = std::max(count_of(one.drive.limits) - count_of(other.drive.limits), 1);
    return gain_of(one, other) > least_gain_ * more;
  }

  void add_lags(const ScoredActuator& best, const LimitedActuatorFit::Spread& spread,
                std::vector<FoundLimit>& found) const {
    LimitedActuator in_front = best.drive;
    in_front.rates_behind_lag = false;
    const double gain = gain_of(best, refined(in_front, kLongRefinement));
    const auto& [v, omega] = spread.lag_std;
    const std::array stds{v, omega, 0.5 * (v + omega)};
    const CommandLimits acting = acting_limits(best.drive);
    for (std::size_t k = 0; k < kLimitedAxes.size(); ++k) {
      if (const double lag = axis_of(acting, kLimitedAxes.at(k)).slew_rate_lag; lag > 0.0) {
        found.push_back({kLimitedAxes.at(k), LimitKind::SlewRateLag, lag, stds.at(k), gain});
      }
    }
  }

  LimitedActuator with_all(LimitedActuator drive) const {
    for (const LimitedAxis axis : {LimitedAxis::Speed, LimitedAxis::YawRate}) {
      limit_all(axis_of(drive.limits, axis), axis_range(records_, drive.limits, axis));
    }
    drive.actuator.time_constant_v *= kLagFactor;
    drive.actuator.time_constant_omega *= kLagFactor;
    return drive;
  }

  /// Fits what there is, and drops or moves what does not earn its place.
  void settle_on(ScoredActuator& best) const {
    best = finished(best);
    while (drop_idle(best) || move_one(best)) {
    }
  }

  /// Adds limits one by one, as long as they gain; whether any was added.
  bool add_all(ScoredActuator& best) const {
    bool added = false;
    for (int i = 0; i < kMostLimits; ++i) {
      const std::optional<ScoredActuator> next = with_one_more(best);
      if (!next) {
        break;
      }
      best = *next;
      added = true;
    }
    return added;
  }

  /// Given up where it does not get below `wanted`.
  ScoredActuator refined(const LimitedActuator& drive, int iterations, double wanted = kAnyLoss) const {
    return fit_.refine(bands_.between_commands(drive), iterations, wanted);
  }

  /// The best limit, or pair of rates, to add; empty if none gains enough.
  std::optional<ScoredActuator> with_one_more(const ScoredActuator& now) const {
    // In the other order the rest was looked for before.
    const bool rates_alone = now.drive.rates_behind_lag && !limits_rates(now.drive.limits);
    std::vector<ScoredActuator> trials;
    for (const LimitedAxis axis : kLimitedAxes) {
      const AxisRange range = axis_range(records_, now.drive.limits, axis);
      const AxisLimits& limits = axis_of(now.drive.limits, axis);
      for (const LimitKind kind : kLimitKinds) {
        if (!limits_anything(limits, kind) && (!rates_alone || row_of(kind).per_second != 0)) {
          add(trials, profile(now, axis, {kind}, range));
        }
      }
      if (!limits_anything(limits, LimitKind::SlewRateUp) && !limits_anything(limits, LimitKind::SlewRateDown)) {
        add(trials, profile(now, axis, {LimitKind::SlewRateUp, LimitKind::SlewRateDown}, range));
      }
    }
    std::ranges::sort(trials, {}, [](const ScoredActuator& trial) { return trial.loss.total; });
    std::optional<ScoredActuator> best;
    for (std::size_t i = 0; i < std::min<std::size_t>(trials.size(), 3); ++i) {
      const double wanted = best ? best->loss.total : now.loss.total - least_gain_;
      const ScoredActuator trial = refined(trials[i].drive, kShortRefinement, wanted);
      if (!best || trial.loss.total < best->loss.total) {
        best = trial;
      }
    }
    // While others are missing, residuals are more alike than they will be; whether each gains enough is judged once
    // all are found.
    const bool gains = best && now.loss.total - best->loss.total >= least_gain_ * std::sqrt(best->loss.inflation);
    return gains ? best : std::nullopt;
  }

  static void add(std::vector<ScoredActuator>& trials, std::optional<ScoredActuator> trial) {
    if (trial) {
      trials.push_back(*std::move(trial));
    }
  }

  /// The best of the candidates, the actuator held but for what took the limit's place: lag that of a rate, gain that
  /// of a saturation.
  std::optional<ScoredActuator> profile(const ScoredActuator& now, LimitedAxis axis,
                                        const std::vector<LimitKind>& kinds, const AxisRange& range) const {
    std::optional<ScoredActuator> best;
    for (const double value : limit_candidates(kinds.front(), range)) {
      LimitedActuator drive = now.drive;
      for (const LimitKind kind : kinds) {
        limit_of(axis_of(drive.limits, axis), kind) = value;
      }
      for (const LimitedActuator& candidate : beside(kinds.front(), drive)) {
        const ScoredActuator trial = fit_.scored(candidate);
        if (!best || trial.loss.total < best->loss.total) {
          best = trial;
        }
      }
    }
    return best;
  }

  static std::vector<LimitedActuator> beside(LimitKind kind, const LimitedActuator& drive) {
    LimitedActuator other = drive;
    if (row_of(kind).per_second > 0) {
      if (drive.rates_behind_lag) {  // what takes no place of the lag leaves it as it is
        return {drive};
      }
      other.actuator.time_constant_v *= kLagFactor;
      other.actuator.time_constant_omega *= kLagFactor;
      return {drive, other};
    }
    if (kind == LimitKind::Saturation) {
      other.limits.gain_v = other.limits.gain_omega = 1.0;
      return {drive, other};
    }
    return {drive};
  }

  /// Finds every dead-band between the commands next to it, and refines the rest with it.
  ScoredActuator finished(const ScoredActuator& rough) const {
    ScoredActuator best = settled(rough);
    // Which commands the sides' dead-band blocks turns on the wheel separation, and no small step of it gets the order
    // right.
    if (best.drive.limits.side.dead_band > 0.0) {
      for (const double factor : kSeparationFactors) {
        ScoredActuator shaken = best;
        shaken.drive.limits.wheel_separation *= factor;
        shaken = settled(fit_.scored(shaken.drive));
        best = shaken.loss.total < best.loss.total ? shaken : best;
      }
    }
    return best;
  }

  ScoredActuator settled(const ScoredActuator& rough) const {
    const ScoredActuator best = bands_.best(rough);
    const ScoredActuator smooth = refined(best.drive, kLongRefinement);
    return smooth.loss.total > best.loss.total ? best : bands_.best(smooth);
  }

  ScoredActuator without(const ScoredActuator& all, LimitedAxis axis, LimitKind kind, double wanted = kAnyLoss) const {
    LimitedActuator drive = all.drive;
    limit_of(axis_of(drive.limits, axis), kind) = limit_of(AxisLimits{}, kind);
    return refined(drive, kShortRefinement, wanted);
  }

  /// Moves a limit to another axis, where it explains more; whether one was moved.
  bool move_one(ScoredActuator& best) const {
    for (const LimitedAxis from : kLimitedAxes) {
      for (const LimitKind kind : kLimitKinds) {
        if (!limits_anything(axis_of(best.drive.limits, from), kind)) {
          continue;
        }
        for (const LimitedAxis to : kLimitedAxes) {
          if (limits_anything(axis_of(best.drive.limits, to), kind)) {
            continue;
          }
          ScoredActuator rest = best;
          limit_of(axis_of(rest.drive.limits, from), kind) = limit_of(AxisLimits{}, kind);
          const std::optional<ScoredActuator> moved =
              profile(rest, to, {kind}, axis_range(records_, rest.drive.limits, to));
          if (!moved) {
            continue;
          }
          ScoredActuator trial = refined(moved->drive, kShortRefinement, best.loss.total + kPruningBound);
          if (trial.loss.total - best.loss.total > kPruningBound) {
            continue;
          }
          trial = finished(trial);
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
  bool drop_idle(ScoredActuator& best) const {
    std::optional<ScoredActuator> idle;
    double least = least_gain_;
    for (const LimitedAxis axis : kLimitedAxes) {
      for (const LimitKind kind : kLimitKinds) {
        if (limits_anything(axis_of(best.drive.limits, axis), kind)) {
          const ScoredActuator less = without(best, axis, kind, best.loss.total + least * best.loss.inflation);
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

  std::span<const WheelRecord> records_;
  const LimitedActuatorFit& fit_;
  DeadBandSearch bands_;
  double least_gain_;
};

LimitedActuator baseline_drive(const LimitedActuatorFit& fit) {
  const LimitedActuator start = fit.start();
  LimitedActuator late = start;
  std::swap(late.actuator.time_constant_v, late.actuator.delay_v);
  std::swap(late.actuator.time_constant_omega, late.actuator.delay_omega);
  const ScoredActuator one = fit.refine(start, kLongRefinement);
  const ScoredActuator other = fit.refine(late, kLongRefinement);
  return one.loss.total <= other.loss.total ? one.drive : other.drive;
}

/// The fit has the gain in front of the sides, limited or not.
LimitedActuator with_gain_at_sides(LimitedActuator drive) {
  drive.limits.gain_v *= std::exchange(drive.actuator.gain_v, 1.0);
  drive.limits.gain_omega *= std::exchange(drive.actuator.gain_omega, 1.0);
  for (const LimitedAxis axis : kLimitedAxes) {
    axis_of(drive.limits, axis).slew_rate_lag = 0.0;  // `acting_limits` has it
  }
  return drive;
}

}  // namespace

LimitSearch find_limits(std::span<const WheelRecord> records, const PriorSettings& prior, double wheel_separation,
                        const LimitSearchSettings& settings, const std::optional<LimitedActuator>& before) {
  const LimitedActuatorFit fit(records, prior, wheel_separation);
  if (fit.samples() < kFewestSamples) {
    throw std::invalid_argument("limits need at least " + std::to_string(kFewestSamples) + " wheel twists, got " +
                                std::to_string(fit.samples()) + "; drive longer");
  }
  Search search(records, fit, settings.least_gain);
  const LimitedActuator plain = baseline_drive(fit);
  ScoredActuator best = search.or_all_at_once(search.run(before ? with_gain_at_sides(*before) : plain), plain);
  best = search.in_other_order(best);
  if (!unlimited(best.drive.limits)) {  // what is found hangs on no step that the search just did not take
    best = fit.refine(best.drive, kLongRefinement, std::numeric_limits<double>::infinity(), kPolished);
  }
  LimitSearch result{.drive = best.drive, .found = {}, .wheel_separation_std = 0.0, .reach = {}};
  if (!unlimited(best.drive.limits)) {
    result.found = search.found(best);
    result.wheel_separation_std = fit.spread(best.drive).wheel_separation_std;
  }
  for (std::size_t k = 0; k < kLimitedAxes.size(); ++k) {
    const AxisRange range = axis_range(records, best.drive.limits, kLimitedAxes.at(k));
    const auto& commands = range.commands;
    result.reach.at(k) =
        commands.empty() ? AxisReach{} : AxisReach{commands.front().speed, commands.back().speed, range.step};
  }
  CommandLimits& limits = result.drive.limits;
  limits = acting_limits(best.drive);
  if (!limits_sides(limits)) {  // the actuator says the gain, and the wheel_separation is not needed
    limits.wheel_separation = wheel_separation;
    result.drive.actuator.gain_v = std::exchange(limits.gain_v, 1.0);
    result.drive.actuator.gain_omega = std::exchange(limits.gain_omega, 1.0);
  }
  return result;
}

}  // namespace slipwise
