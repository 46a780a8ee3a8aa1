// SPDX-License-Identifier: Apache-2.0
// Integrals of numbers at stamps.
#include "slipwise/online/reading.hpp"

#include <algorithm>
#include <iterator>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kMissing = 0.25;  // [s] between samples, over which the robot may have moved otherwise

double at(const TimedNumber& first, const TimedNumber& second, double t) {
  const double part = (t - first.t) / (second.t - first.t);
  return first.value + part * (second.value - first.value);
}

}  // namespace

std::optional<double> integral(const std::deque<TimedNumber>& numbers, double start, double end) {
  auto next = std::ranges::upper_bound(numbers, start + kSameStamp, {}, &TimedNumber::t);
  if (next == numbers.begin() || next == numbers.end()) {
    return std::nullopt;
  }
  double sum = 0.0;
  double now = start;
  for (; next != numbers.end(); ++next) {
    const TimedNumber& before = *std::prev(next);
    if (later(next->t, before.t + kMissing)) {
      return std::nullopt;
    }
    const double until = std::min(next->t, end);
    sum += (until - now) * at(before, *next, 0.5 * (now + until));
    now = until;
    if (!later(end, next->t)) {
      return sum;
    }
  }
  return std::nullopt;
}

void drop_before(std::deque<TimedNumber>& numbers, double t) {
  while (numbers.size() > 1 && numbers[1].t <= t) {
    numbers.pop_front();
  }
}

}  // namespace slipwise
