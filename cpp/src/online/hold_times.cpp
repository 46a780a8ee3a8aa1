// SPDX-License-Identifier: Apache-2.0
// How long each input was held, weighted by that time.
#include "slipwise/online/hold_times.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kSame = 0.2;      // of the fastest input so far, within which one counts as held
constexpr double kFraction = 0.9;  // of the driving time

}  // namespace

void HoldTimes::Axis::end(double t) {
  if (std::abs(value) > kSame * fastest && t > since) {
    held.add(t - since, t - since);
  }
  value = 0.0;
}

void HoldTimes::Axis::take(double input, double t, double ended) {
  fastest = std::max(fastest, std::abs(input));
  if (later(t, ended) || std::abs(input - value) > kSame * fastest) {
    end(ended);
    value = input;
    since = t;
  }
}

void HoldTimes::push(const InputSample& sample) {
  const double t = sample.t;
  const double ended = last_ ? std::min(t, *last_ + unknown_after_) : t;
  const std::array values{sample.twist.v, sample.twist.omega};
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    axes_[i].take(values[i], t, ended);
  }
  last_ = t;
}

void HoldTimes::restart() {
  for (Axis& axis : axes_) {
    axis.end(last_.value_or(axis.since));
  }
  last_.reset();
}

std::array<double, 2> HoldTimes::found() const {
  return {axes_[0].held.value(kFraction), axes_[1].held.value(kFraction)};
}

}  // namespace slipwise
