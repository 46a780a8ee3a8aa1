// SPDX-License-Identifier: Apache-2.0
// Measured attitudes, kept as long as a segment may need them.
#include "slipwise/online/tilt_buffer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/slip/term.hpp"

namespace slipwise {
namespace {

constexpr double kTiltsApart = 0.02;  // [s]; a robot's tilt changes more slowly

}  // namespace

void TiltBuffer::push(const Tilt& tilt) {
  if (tilts_.empty() || !later(tilts_.back().t + kTiltsApart, tilt.t)) {
    tilts_.push_back(tilt);
  }
}

std::optional<Tilt> TiltBuffer::known_at(double t, double oldest) const {
  const auto after = std::ranges::upper_bound(tilts_, t + kSameStamp, {}, &Tilt::t);
  if (after == tilts_.begin() || later(t, std::prev(after)->t + oldest)) {
    return std::nullopt;
  }
  return *std::prev(after);
}

std::shared_ptr<const Ground> TiltBuffer::along(double start, double end, double oldest) const {
  if (!known_at(start, oldest)) {
    return nullptr;
  }
  const auto first = std::prev(std::ranges::upper_bound(tilts_, start + kSameStamp, {}, &Tilt::t));
  auto last = std::ranges::lower_bound(tilts_, end, {}, &Tilt::t);
  last = last == tilts_.end() ? last : std::next(last);
  return std::make_shared<const Ground>(MeasuredTilts{{first, last}});
}

std::shared_ptr<const Ground> TiltBuffer::from(double start, double oldest) const {
  const auto tilt = known_at(start, oldest);
  return tilt ? std::make_shared<const Ground>(grade_of(*tilt)) : nullptr;
}

void TiltBuffer::drop_before(double t) {
  while (tilts_.size() > 1 && tilts_[1].t < t) {
    tilts_.pop_front();
  }
}

BodyGravity gravity_of(const Tilt& tilt) {
  return {.gx = kStandardGravity * std::sin(tilt.pitch),
          .gy = -kStandardGravity * std::cos(tilt.pitch) * std::sin(tilt.roll)};
}

}  // namespace slipwise
