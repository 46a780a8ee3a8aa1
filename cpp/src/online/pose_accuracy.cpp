// SPDX-License-Identifier: Apache-2.0
// A mean over the logarithms of standard deviations.
#include "slipwise/online/pose_accuracy.hpp"

#include <algorithm>
#include <cmath>

namespace slipwise {
namespace {

constexpr std::size_t kCounted = 1000;  // poses: a minute of 20 Hz is not yet the nominal
const double kMostRatio = std::log(1e3);

}  // namespace

double NominalStd::ratio(double std) {
  if (!(std > 0.0)) {
    return 1.0;
  }
  const double log_std = std::log(std);
  if (count_ == 0) {
    log_mean_ = log_std;
  }
  const double above = std::clamp(log_std - log_mean_, -kMostRatio, kMostRatio);
  count_ = std::min(count_ + 1, kCounted);
  log_mean_ += above / static_cast<double>(count_);
  return std::exp(above);
}

}  // namespace slipwise
