// SPDX-License-Identifier: Apache-2.0
// The trapezoid of speed and its derivative by its length (derivations/rollouts.md).
#include "slipwise/planning/speed_profile.hpp"

#include <algorithm>
#include <cmath>

namespace slipwise {

double SpeedProfile::shortest(const SpeedEnds& ends, double acceleration) {
  return std::abs(ends.end * ends.end - ends.start * ends.start) / (2.0 * acceleration);
}

SpeedProfile::SpeedProfile(const SpeedEnds& ends, double acceleration, double length)
    : ends_(ends), acceleration_(acceleration), length_(length) {
  const double squares = 0.5 * (ends.start * ends.start + ends.end * ends.end);
  peak_ = std::min(ends.cruise, std::sqrt(acceleration * length + squares));
  const double ramps = (peak_ * peak_ - squares) / acceleration;  // length of both together
  duration_ = (2.0 * peak_ - ends.start - ends.end) / acceleration + (length - ramps) / peak_;
}

ByLength SpeedProfile::distance(double fraction) const {
  const double per_length = 1.0 / peak_;
  const double t = fraction * duration_;
  const double up = (peak_ - ends_.start) / acceleration_;
  const double left = duration_ - t;
  const double down = (peak_ - ends_.end) / acceleration_;
  if (t < up) {
    const double speed = ends_.start + acceleration_ * t;
    return {0.5 * (ends_.start + speed) * t, speed * fraction * per_length};
  }
  if (left < down) {  // measured from the end, which moves with the length
    const double speed = ends_.end + acceleration_ * left;
    return {length_ - 0.5 * (ends_.end + speed) * left, 1.0 - speed * (1.0 - fraction) * per_length};
  }
  return {0.5 * (ends_.start + peak_) * up + peak_ * (t - up), fraction};
}

}  // namespace slipwise
