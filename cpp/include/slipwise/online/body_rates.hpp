// SPDX-License-Identifier: Apache-2.0
// How fast the body of a robot moved, and how quickly that changed, as its poses show it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "slipwise/filter/speed_range.hpp"
#include "slipwise/lie/body_twist.hpp"
#include "slipwise/lie/se2.hpp"
#include "slipwise/online/pose_gate.hpp"

namespace slipwise {

/// The greatest of many magnitudes, without those of the last hundredth, which may be faults.
class RobustGreatest {
 public:
  /// Adds a magnitude of 0 or more; the larger its `weight`, the more it counts.
  void add(double magnitude, double weight);
  /// The magnitude below which `fraction` of the weight lies; 0 where none was added.
  double value(double fraction) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.range_, self.greatest_);
  }

 private:
  SpeedRange range_;
  double greatest_ = 0.0;
};

/// Rates that 99 % of the motion stayed below, of the body; 0 where none was seen.
struct MeasuredRates {
  std::array<double, 2> speed = {};         ///< backward, forward [m/s], as magnitudes
  std::array<double, 2> yaw_rate = {};      ///< to the right, to the left [rad/s], as magnitudes
  std::array<double, 2> acceleration = {};  ///< away from standstill and towards it [m/s^2]
  std::array<double, 2> turning = {};       ///< the same of the yaw rate [rad/s^2]
  double seconds = 0.0;                     ///< between the poses that show them
};

/// How much poses scatter about a smooth way: each with what the one before it and the two after it say, in constant
/// memory.
class PoseScatter {
 public:
  void push(const MeasuredPose& pose);
  /// Standard deviation of an axis [m]; 0 where poses are too rare to tell.
  double place() const;
  /// Of the heading [rad].
  double yaw() const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.last_, self.count_, self.places_, self.yaws_);
  }

 private:
  std::array<MeasuredPose, 4> last_ = {};  ///< the newest last
  std::size_t count_ = 0;                  ///< of these, that follow each other closely
  SpeedRange places_;                      ///< [mm]
  SpeedRange yaws_;                        ///< [mrad]
};

/// Takes the poses of one run after another, and remembers in constant memory. Rates are means over half a second:
/// over less, noise of poses hides the motion, so that a quicker change counts as less than it was. What is left of the
/// noise is taken off the greatest.
class BodyRates {
 public:
  /// `sensor` is where the pose sensor sits in base_link.
  explicit BodyRates(const Pose2& sensor) : sensor_(sensor) {}

  /// Takes a pose that is not late, its yaw unwrapped. A position alone tells no yaw rate.
  void push(const MeasuredPose& pose);
  /// Another run begins.
  void restart();
  MeasuredRates found() const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.sensor_, self.from_, self.last_, self.last_seconds_, self.scatter_, self.speed_, self.yaw_rate_,
      self.acceleration_, self.turning_, self.seconds_);
  }

 private:
  void take(const BodyTwist& twist, double seconds, bool turns);

  Pose2 sensor_;
  std::optional<MeasuredPose> from_;  ///< where the next mean begins
  std::optional<BodyTwist> last_;     ///< the mean before it
  double last_seconds_ = 0.0;
  PoseScatter scatter_;
  std::array<RobustGreatest, 2> speed_;
  std::array<RobustGreatest, 2> yaw_rate_;
  std::array<RobustGreatest, 2> acceleration_;
  std::array<RobustGreatest, 2> turning_;
  double seconds_ = 0.0;
};

}  // namespace slipwise
