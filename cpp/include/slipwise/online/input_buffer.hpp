// SPDX-License-Identifier: Apache-2.0
// What a robot was commanded, or its wheels did, of late: samples under zero-order hold, in bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "slipwise/actuator/input_history.hpp"
#include "slipwise/archive/bytes.hpp"
#include "slipwise/lie/body_twist.hpp"
#include "slipwise/lie/se2.hpp"

namespace slipwise {

/// One input at its stamp.
struct InputSample {
  double t;  ///< [s]
  BodyTwist twist;
};

/// What inputs say over a time: the integrals of their speeds, and for how long they are known.
struct HeldMotion {
  double forward;   ///< [m]
  double sideways;  ///< [m]
  double rotation;  ///< [rad]
  double known;     ///< [s]
};

/// How a slice of the history begins, and what of it is kept.
enum class SliceKind : std::uint8_t {
  Commands,  ///< before the first one the robot is at rest; repeats are thinned
  Wheels,    ///< wheel speeds may begin while the robot drives: the first one holds for a while before it
  Measured   ///< the same, but each stands for the time nearest to its stamp: held, it would pass for a delay
};

/// The samples of the last seconds of a run. Each is held until the next one, and unknown once it is older than
/// `unknown_after`.
class InputBuffer {
 public:
  explicit InputBuffer(double unknown_after) : unknown_after_(unknown_after) {}

  /// Adds a sample, whose stamp is later than those before.
  void push(const InputSample& sample);
  /// Forgets all: another run begins.
  void clear();
  /// Drops what ended before `t` [s], but for the sample that is held then.
  void drop_before(double t);

  bool empty() const { return samples_.empty(); }
  std::size_t size() const { return samples_.size(); }
  double newest() const { return samples_.back().t; }
  double unknown_after() const { return unknown_after_; }
  /// The first sample of the run [s]; there must be one.
  double first() const { return first_; }
  /// The fastest speed (v and vy together) and yaw rate of the run until `t` [s].
  BodyTwist fastest_until(double t) const;

  /// The twist at `t` [s], where it is known.
  std::optional<BodyTwist> known_at(double t) const;
  /// The twist held at `t` [s], however old it is; nothing before the first sample.
  std::optional<BodyTwist> held_at(double t) const;
  /// From when on the sample held at `t` [s] was measured: it stands for the time nearest to its stamp. There must be
  /// one.
  double measured_since(double t) const;
  /// When the input becomes unknown first in [start, end] [s]; `start` where it is unknown there already.
  std::optional<double> unknown_since(double start, double end) const;
  /// The first sample later than `t` [s].
  std::optional<double> first_after(double t) const;
  /// The greatest speed and yaw rate held in [start, end], as (v and vy together, omega).
  BodyTwist fastest(double start, double end) const;
  /// Distance and angle driven in [start, end], and the time for which the input is known.
  struct Driven {
    double distance;  ///< [m]
    double angle;     ///< [rad]
    double known;     ///< [s]
  };
  Driven driven(double start, double end) const;
  /// The integrals over [start, end] [s], while inputs are known.
  HeldMotion held_motion(double start, double end) const;
  /// What is held over [start, end] [s]: the first from `start` on, each until the next.
  std::vector<InputSample> held(double start, double end) const;
  /// The motion over [start, end] [s] that the inputs held then make, T_start_end.
  Pose2 reckoned(double start, double end) const;

  /// The samples that act in [start, end], then `future` ones up to `end`, as the core's inputs.
  InputHistory slice(double start, double end, SliceKind kind, const std::vector<InputSample>& future = {}) const;

  /// \throws std::invalid_argument where a loaded one is of other settings than `made`, or not in order.
  void check_loaded(const InputBuffer& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.unknown_after_, self.samples_, self.fastest_, self.first_);
    if (self.samples_.size() != self.fastest_.size()) {
      slipwise::archive::refuse("malformed: inputs and their greatest speeds differ in number");
    }
  }

 private:
  /// The index after the last sample with a stamp of at most t.
  std::size_t count_until(double t) const;

  double unknown_after_;
  std::deque<InputSample> samples_;
  std::deque<BodyTwist> fastest_;  ///< until each sample, itself included
  double first_ = 0.0;
};

}  // namespace slipwise
