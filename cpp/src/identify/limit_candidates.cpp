// SPDX-License-Identifier: Apache-2.0
// Quantiles of commands, measured speeds and measured accelerations.
#include "slipwise/identify/limit_candidates.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace slipwise {
namespace {

constexpr std::array kDeadBandQuantiles{0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6};
constexpr std::array kSaturationQuantiles{0.5, 0.7, 0.8, 0.9, 0.95, 0.98};
constexpr std::array kRateFactors{0.3, 0.5, 0.8, 1.2, 2.0, 3.5, 6.0};
constexpr double kHighest = 0.98;  // quantile of speeds that is about a top
constexpr double kNominal = 0.9;   // quantile of rates

double quantile(const std::vector<double>& sorted, double fraction) {
  return sorted[static_cast<std::size_t>(fraction * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

std::vector<double> limit_candidates(LimitKind kind, const AxisRange& range) {
  std::vector<double> values;
  if (range.commands.size() < 2 || range.speeds.empty() || range.rates.empty()) {
    return values;
  }
  if (kind == LimitKind::DeadBand) {
    for (const double fraction : kDeadBandQuantiles) {
      const auto at = static_cast<std::size_t>(fraction * static_cast<double>(range.commands.size() - 2));
      values.push_back(0.5 * (range.commands[at].speed + range.commands[at + 1].speed));
    }
  } else if (kind == LimitKind::Saturation) {
    for (const double fraction : kSaturationQuantiles) {
      const double saturation = quantile(range.speeds, fraction);
      if (saturation > 0.0 && saturation < range.commands.back().speed) {
        values.push_back(saturation);
      }
    }
  } else if (const double nominal = quantile(range.rates, kNominal); nominal > 0.0) {
    for (const double factor : kRateFactors) {
      values.push_back(factor * nominal);
    }
  }
  return values;
}

void limit_all(AxisLimits& limits, const AxisRange& range) {
  if (range.commands.empty() || range.speeds.empty() || range.rates.empty()) {
    return;
  }
  if (const double saturation = quantile(range.speeds, kHighest); saturation > 0.0) {
    limits.saturation = saturation;
  }
  if (const double nominal = quantile(range.rates, kNominal); nominal > 0.0) {
    limits.slew_rate_up = limits.slew_rate_down = nominal;
  }
}

}  // namespace slipwise
