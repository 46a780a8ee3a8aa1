// SPDX-License-Identifier: Apache-2.0
// Sample-and-hold inputs.
#include "slipwise/actuator/input_track.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace slipwise {

InputTrack::InputTrack(std::span<const double> t, std::span<const double> v, std::span<const double> vy,
                       std::span<const double> omega)
    : t_(t.begin(), t.end()) {
  if (v.size() != t.size() || vy.size() != t.size() || omega.size() != t.size()) {
    throw std::invalid_argument("inputs t, v, vy, omega must have equal lengths, got " + std::to_string(t.size()) +
                                ", " + std::to_string(v.size()) + ", " + std::to_string(vy.size()) + ", " +
                                std::to_string(omega.size()));
  }
  samples_.reserve(t.size());
  for (std::size_t i = 0; i < t.size(); ++i) {
    const bool finite = std::isfinite(t[i]) && std::isfinite(v[i]) && std::isfinite(vy[i]) && std::isfinite(omega[i]);
    if (!finite || (i > 0 && t[i] <= t[i - 1])) {
      throw std::invalid_argument("input " + std::to_string(i) +
                                  " is not finite or its time does not increase; clean the log first");
    }
    samples_.push_back({v[i], vy[i], omega[i]});
  }
}

std::size_t InputTrack::count_until(double t) const {
  return static_cast<std::size_t>(std::ranges::upper_bound(t_, t) - t_.begin());
}

BodyTwist InputTrack::at(double t) const {
  const std::size_t count = count_until(t);
  return count == 0 ? BodyTwist{} : samples_[count - 1];
}

}  // namespace slipwise
