// SPDX-License-Identifier: Apache-2.0
// Which input is held at a stamp.
#include "slipwise/dynamics/held_inputs.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {}  // namespace

void HeldInputs::push(double t, Eigen::VectorXd input) {
  if (!std::isfinite(t) || !input.allFinite()) {
    throw std::invalid_argument("an input or its stamp is not finite");
  }
  if (!inputs_.empty() && input.size() != inputs_.back().second.size()) {
    throw std::invalid_argument("an input has another size than those before it");
  }
  if (!inputs_.empty() && !(t > inputs_.back().first)) {
    throw std::invalid_argument("inputs must be in the order of their stamps, each later than the last");
  }
  inputs_.emplace_back(t, std::move(input));
}

/// The first of them.
HeldInputs::Inputs::const_iterator HeldInputs::later_than(double t) const {
  return std::ranges::upper_bound(inputs_, t, {}, [](const auto& input) { return input.first - kSameStamp; });
}

void HeldInputs::forget_before(double t) {
  if (const auto next = later_than(t); next != inputs_.begin()) {
    inputs_.erase(inputs_.begin(), std::prev(next));
  }
}

const Eigen::VectorXd& HeldInputs::at(double t) const {
  const auto next = later_than(t);
  if (next == inputs_.begin()) {
    throw std::invalid_argument("there is no input yet; give one that begins no later than the first measurement");
  }
  return std::prev(next)->second;
}

double HeldInputs::until(double t, double end) const {
  const auto next = later_than(t);
  return next == inputs_.end() ? end : std::min(next->first, end);
}

}  // namespace slipwise
