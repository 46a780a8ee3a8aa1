// SPDX-License-Identifier: Apache-2.0
// Yaw rates of a gyro of late, the turns that they make, and the gyro's bias.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "slipwise/online/input_buffer.hpp"
#include "slipwise/online/pose_gate.hpp"
#include "slipwise/online/reading.hpp"
#include "slipwise/segment/segment.hpp"
#include "slipwise/sensor/sensor.hpp"

namespace slipwise {

/// A turn that a gyro measured.
struct GyroTurn {
  double angle;  ///< [rad]
  double std;    ///< [rad]
};

Measured measured_turn(const GyroTurn& turn);

/// Yaw rates in the order of their stamps. The bias is learned where the inputs stand still, and from turns of the
/// course over longer times; it may drift.
class GyroBuffer {
 public:
  static constexpr ReadingKind kKind{
      .column = "gyro_z", .sensor = "gyro", .unit = "rad/s", .meaning = "measured yaw rate, counter-clockwise"};

  /// Adds a sample, whose stamp is later than those before.
  void push(const TimedNumber& sample) { samples_.push_back(sample); }
  /// Learns the bias from the samples until `t` [s], where `inputs`, which are known until then, stand still.
  void see_inputs(double t, const InputBuffer& inputs, double still_speed);
  /// Learns the bias from where a position's course heads.
  void see_course(const MeasuredPose& position);
  /// The turn over [start, end] [s]; empty if samples are missing.
  std::optional<GyroTurn> turn(double start, double end) const;
  /// The turns in so many equally long pieces of it; empty if samples are missing.
  std::optional<Measured> turns(double start, double end, Eigen::Index pieces) const;
  /// Between positions it measures how the robot turned, in a few pieces one after the other.
  void measure(Segment& segment) const;
  /// [rad/s], and its standard deviation.
  double bias() const { return bias_; }
  double bias_std() const;
  void drop_before(double t) { slipwise::drop_before(samples_, t); }
  /// Another run begins; the bias stays.
  void restart();

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.samples_, self.bias_, self.variance_, self.seen_until_, self.course_);
  }

 private:
  void learn_bias(double measured, double variance);

  std::deque<TimedNumber> samples_;     ///< yaw rates, counter-clockwise [rad/s]
  double bias_ = 0.0;                   ///< [rad/s]
  double variance_ = 4e-4;              ///< of the bias
  std::optional<double> seen_until_;    ///< inputs were looked at until then [s]
  std::optional<MeasuredPose> course_;  ///< since which the course's turn is compared
};

}  // namespace slipwise
