// SPDX-License-Identifier: Apache-2.0
// Gates that remember no more than the last sample.
#include "slipwise/online/sample_gate.hpp"

#include <algorithm>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kOrdinary = 20.0;  // [m/s, rad/s] a command, or the first sample, that is slower is always accepted
constexpr double kStep = 5.0;       // [m/s, rad/s] wheels that are measured, and slower, are always accepted
constexpr double kFastest = 100.0;  // [m/s, rad/s] what is slower is accepted once it comes twice in a row
constexpr double kLeap = 15.0;      // anything is accepted up to this many times the fastest before it
constexpr double kTwice = 2.0;      // a sample at most this many times the one before confirms it

}  // namespace

std::optional<Reason> StampGate::check(double t, std::span<const double> numbers) {
  const bool finite = std::isfinite(t) && std::ranges::all_of(numbers, [](double number) {
                        return std::abs(number) < kLargestNumber;  // false for NaN
                      });
  if (!finite) {
    return Reason::NotFinite;
  }
  if (std::abs(t) > kLatestStamp) {
    return Reason::ImpossibleStamp;
  }
  if (!later(t, latest_)) {
    return same_stamp(t, latest_) ? Reason::DuplicateStamp : Reason::BackwardStamp;
  }
  latest_ = t;
  return std::nullopt;
}

bool SpeedGate::plausible(double value, bool measured) {
  const double size = std::abs(value);
  const double before = before_;
  before_ = size;
  const bool first = fastest_ < 0.0;
  const double usual = measured ? kStep : kOrdinary;
  const bool near = size <= (first ? kOrdinary : std::max(usual, kLeap * fastest_));
  const bool confirmed = size <= std::min(kFastest, kTwice * before);
  if (!near && !confirmed) {
    return false;
  }
  const bool believed = size <= usual || confirmed || !first;
  fastest_ = std::max(fastest_, believed ? size : 0.0);
  return true;
}

}  // namespace slipwise
