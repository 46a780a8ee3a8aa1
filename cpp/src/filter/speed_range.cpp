// SPDX-License-Identifier: Apache-2.0
// A causal quantile of speeds.
#include "slipwise/filter/speed_range.hpp"

#include <algorithm>
#include <cmath>

namespace slipwise {
namespace {

constexpr double kSmallest = 1e-3;
const double kLogWidth = std::log(1.05);

}  // namespace

void SpeedRange::add(double value, double seconds) {
  const double magnitude = std::abs(value);
  if (!(magnitude >= kSmallest)) {
    return;
  }
  const auto bin = static_cast<std::size_t>(std::log(magnitude / kSmallest) / kLogWidth);
  seconds_[std::min(bin, kBins - 1)] += seconds;
  total_ += seconds;
}

double SpeedRange::quantile(double fraction, double floor) const {
  double below = 0.0;
  for (std::size_t bin = 0; bin < kBins && total_ > 0.0; ++bin) {
    below += seconds_[bin];
    if (below >= fraction * total_) {
      return std::max(floor, kSmallest * std::exp(kLogWidth * (static_cast<double>(bin) + 0.5)));
    }
  }
  return floor;
}

double SpeedRange::upper(double fraction) const { return quantile(fraction, 0.0) * std::exp(0.5 * kLogWidth); }

}  // namespace slipwise
