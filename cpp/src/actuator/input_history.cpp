// SPDX-License-Identifier: Apache-2.0
// Sample-and-hold inputs.
#include "slipwise/actuator/input_history.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace slipwise {
namespace {

std::vector<BodyTwist> joined(std::span<const double> t, std::span<const double> v, std::span<const double> vy,
                              std::span<const double> omega) {
  if (v.size() != t.size() || vy.size() != t.size() || omega.size() != t.size()) {
    throw std::invalid_argument("inputs t, v, vy, omega must have equal lengths, got " + std::to_string(t.size()) +
                                ", " + std::to_string(v.size()) + ", " + std::to_string(vy.size()) + ", " +
                                std::to_string(omega.size()));
  }
  std::vector<BodyTwist> twist;
  twist.reserve(t.size());
  for (std::size_t i = 0; i < t.size(); ++i) {
    twist.push_back({v[i], vy[i], omega[i]});
  }
  return twist;
}

}  // namespace

InputHistory::InputHistory(std::span<const double> t, std::span<const double> v, std::span<const double> vy,
                           std::span<const double> omega)
    : InputHistory({t.begin(), t.end()}, joined(t, v, vy, omega)) {}

InputHistory::InputHistory() : samples_(std::make_shared<const Samples>()) {}

InputHistory::InputHistory(std::vector<double> t, std::vector<BodyTwist> twist)
    : samples_(std::make_shared<const Samples>(Samples{std::move(t), std::move(twist)})) {
  check_samples();
}

void InputHistory::check_samples() const {
  if (!samples_) {
    throw std::invalid_argument("inputs without samples");
  }
  const auto& [t, twist] = *samples_;
  if (twist.size() != t.size()) {
    throw std::invalid_argument("inputs need a twist at each time, got " + std::to_string(twist.size()) + " and " +
                                std::to_string(t.size()));
  }
  for (std::size_t i = 0; i < t.size(); ++i) {
    const auto& [v, vy, omega] = twist[i];
    const bool finite = std::isfinite(t[i]) && std::isfinite(v) && std::isfinite(vy) && std::isfinite(omega);
    if (!finite || (i > 0 && t[i] <= t[i - 1])) {
      throw std::invalid_argument("input " + std::to_string(i) +
                                  " is not finite or its time does not increase; clean the log first");
    }
  }
}

std::size_t InputHistory::count_until(double t) const {
  return static_cast<std::size_t>(std::ranges::upper_bound(samples_->t, t) - samples_->t.begin());
}

BodyTwist InputHistory::at(double t) const {
  const std::size_t count = count_until(t);
  return count == 0 ? BodyTwist{} : samples_->twist[count - 1];
}

}  // namespace slipwise
