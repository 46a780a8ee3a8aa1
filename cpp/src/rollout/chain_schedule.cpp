// SPDX-License-Identifier: Apache-2.0
// Cutting the control period where delayed commands begin to act.
#include "slipwise/rollout/chain_schedule.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "slipwise/actuator/command_chain.hpp"
#include "slipwise/actuator/first_order_lag.hpp"

namespace slipwise {
namespace {

constexpr double kMostPeriods = 1e6;  // that a command may take to act
constexpr double kSamePart = 1e-9;    // of a period: delays that differ by less act together

/// A channel's delay: whole periods, and the time within a period at which a command begins to act.
struct Delay {
  std::ptrdiff_t periods;
  double rest;
};

Delay split_delay(double delay, double period) {
  double whole = std::floor(delay / period);
  if (!(std::abs(whole) <= kMostPeriods)) {
    throw std::invalid_argument("a command that acts after " + std::to_string(delay) + " s is more than " +
                                std::to_string(kMostPeriods) + " periods of " + std::to_string(period) +
                                " s late; use longer periods");
  }
  double rest = delay - whole * period;
  if (rest > (1.0 - kSamePart) * period) {
    whole += 1.0;
    rest = 0.0;
  }
  return {static_cast<std::ptrdiff_t>(whole), rest < kSamePart * period ? 0.0 : rest};
}

LagShare share_of(double time_constant, double duration) {
  const LagDecay decay(time_constant, duration);
  return {time_constant > 0.0 ? time_constant * decay.gone / duration : 0.0, decay.left};
}

/// Cuts a stretch so that no part with lag is longer than the chain's own steps are.
void append_parts(const CommandChain& chain, PeriodPart part, bool lags, std::vector<PeriodPart>& parts) {
  const int count = lags ? std::max(1, static_cast<int>(std::ceil(part.duration / DriveWindow{}.longest_step))) : 1;
  part.duration /= count;
  part.lag_v = share_of(chain.lag_v, part.duration);
  part.lag_omega = share_of(chain.lag_omega, part.duration);
  for (int i = 0; i < count; ++i) {
    parts.push_back(part);
    part.next_v = part.next_omega = false;
  }
}

}  // namespace

ChainSchedule schedule_chain(const CommandChain& chain, double period) {
  if (!(period > 0.0 && std::isfinite(period))) {
    throw std::invalid_argument("the time between two commands must be a positive number of seconds, got " +
                                std::to_string(period));
  }
  const Delay v = split_delay(chain.delay_v + chain.clock_offset, period);
  const Delay omega = split_delay(chain.delay_omega + chain.clock_offset, period);
  ChainSchedule schedule{period, v.periods, omega.periods, chain.lag_v > 0.0 || chain.lag_omega > 0.0, {}};
  std::vector<double> cuts{0.0, v.rest, omega.rest, period};
  std::ranges::sort(cuts);
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    if (cuts[i + 1] > cuts[i]) {
      const PeriodPart part{cuts[i + 1] - cuts[i], v.rest == cuts[i], omega.rest == cuts[i], {}, {}};
      append_parts(chain, part, schedule.lags, schedule.parts);
    }
  }
  return schedule;
}

}  // namespace slipwise
