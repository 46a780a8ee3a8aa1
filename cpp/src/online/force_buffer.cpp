// SPDX-License-Identifier: Apache-2.0
// Known forces, kept as long as a segment may need them.
#include "slipwise/online/force_buffer.hpp"

#include <algorithm>
#include <iterator>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {

std::optional<KnownForce> ForceBuffer::at(double t) const {
  const auto after = std::ranges::upper_bound(forces_, t + kSameStamp, {}, &KnownForce::t);
  return after == forces_.begin() ? std::nullopt : std::optional(*std::prev(after));
}

std::optional<KnownForce> ForceBuffer::mean(double start, double end) const {
  if (forces_.empty() || !later(end, forces_.front().t)) {
    return std::nullopt;
  }
  KnownForce held = at(start).value_or(KnownForce{start, 0.0, 0.0});
  KnownForce sum{start, 0.0, 0.0};
  const auto hold_until = [&](double t) {
    sum.x += held.x * (t - sum.t);
    sum.y += held.y * (t - sum.t);
    sum.t = t;
  };
  auto next = std::ranges::upper_bound(forces_, start + kSameStamp, {}, &KnownForce::t);
  for (; next != forces_.end() && next->t < end; ++next) {
    hold_until(next->t);
    held = *next;
  }
  hold_until(end);
  return KnownForce{start, sum.x / (end - start), sum.y / (end - start)};
}

void ForceBuffer::drop_before(double t) {
  while (forces_.size() > 1 && forces_[1].t < t) {
    forces_.pop_front();
  }
}

}  // namespace slipwise
