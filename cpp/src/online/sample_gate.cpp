// SPDX-License-Identifier: Apache-2.0
// Gates that remember no more than the last sample.
#include "slipwise/online/sample_gate.hpp"

#include <algorithm>

namespace slipwise {
namespace {

constexpr double kOrdinary = 20.0;  // [m/s, rad/s] what is slower is always accepted
constexpr double kFastest = 100.0;  // [m/s, rad/s] what is slower is accepted once it comes twice in a row
constexpr double kLeap = 10.0;      // anything is accepted up to this many times the fastest before it
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
  if (!(t > latest_)) {
    return t == latest_ ? Reason::DuplicateStamp : Reason::BackwardStamp;
  }
  latest_ = t;
  return std::nullopt;
}

bool SpeedGate::plausible(double value) {
  const double size = std::abs(value);
  const double before = before_;
  before_ = size;
  const bool near = size <= std::max(kOrdinary, kLeap * fastest_);
  const bool confirmed = size <= std::min(kFastest, kTwice * before);
  if (size > kOrdinary && !near && !confirmed) {
    return false;
  }
  fastest_ = std::max(fastest_, size);
  return true;
}

}  // namespace slipwise
