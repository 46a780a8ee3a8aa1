// SPDX-License-Identifier: Apache-2.0
// Speed along a stretch of given length: up to a cruise speed, along, and down, within an acceleration.
#pragma once

namespace slipwise {

/// The speeds that a profile joins; all are magnitudes [m/s].
struct SpeedEnds {
  double start = 0.0;
  double cruise = 1.0;  ///< reached where the stretch is long enough; at least `start` and `end`
  double end = 0.0;
};

/// A value with its derivative by the length of the stretch.
struct ByLength {
  double value;
  double derivative;
};

/// Trapezoid of speed over time, or a triangle where the stretch is short.
class SpeedProfile {
 public:
  /// `length` [m] is at least shortest(); `acceleration` is positive [m/s^2].
  SpeedProfile(const SpeedEnds& ends, double acceleration, double length);

  /// The shortest stretch on which the speed can change from start to end.
  static double shortest(const SpeedEnds& ends, double acceleration);

  double peak() const { return peak_; }
  /// How long it takes [s].
  ByLength duration() const { return {duration_, 1.0 / peak_}; }
  /// The distance [m] after a fraction of the duration, 0 to 1.
  ByLength distance(double fraction) const;

 private:
  SpeedEnds ends_;
  double acceleration_;
  double length_;
  double peak_;
  double duration_;
};

}  // namespace slipwise
