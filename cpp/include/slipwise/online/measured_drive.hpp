// SPDX-License-Identifier: Apache-2.0
// What was measured of late beside poses, and the segments that it drives: complete ones, and those ahead.
#pragma once

#include <optional>
#include <vector>

#include "slipwise/online/car_stream.hpp"
#include "slipwise/online/force_buffer.hpp"
#include "slipwise/online/input_buffer.hpp"
#include "slipwise/online/measurement.hpp"
#include "slipwise/online/pose_source.hpp"
#include "slipwise/online/readings.hpp"
#include "slipwise/online/segment_cutter.hpp"
#include "slipwise/online/stream_settings.hpp"
#include "slipwise/online/tilt_buffer.hpp"
#include "slipwise/segment/driven_segment.hpp"

namespace slipwise {

/// Inputs, tilts, forces and readings of one run, as long as segments may need them.
struct MeasuredDrive {
  StreamSettings settings;
  InputBuffer commands;  ///< of a car, what is expected of throttle and steering
  InputBuffer wheels;
  TiltBuffer tilts = {};
  ForceBuffer forces = {};
  Readings readings = {};
  std::optional<CarStream> car = {};  ///< where commands are throttle and steering

  explicit MeasuredDrive(const StreamSettings& given);

  void start_run();
  void drop_before(double t);

  /// What motion is predicted from.
  const InputBuffer& inputs() const { return settings.from_commands ? commands : wheels; }
  /// What throttle and steering do, where they are the commands.
  std::optional<CarCurves> car_curves() const { return car ? std::optional(car->curves()) : std::nullopt; }
  /// Wheel speeds tell where the robot can have come, where there are some by then.
  const InputBuffer& gate_inputs(double t) const;
  /// A pose with its context: how the robot was tilted, and how exact its like were.
  MeasuredPose complete(const MeasuredPose& raw, PoseAccuracies& accuracies) const;
  /// Segments between positions with what all these tell of the motion; those of which they tell no course are
  /// rejected.
  std::vector<SegmentCut> fitted(std::vector<SegmentCut> cuts, const Pose2& place) const;

  /// A segment to be learned, or over a `horizon` to be predicted from what was known one horizon before.
  DrivenSegment driven(const SegmentCut& cut, bool by_wheels, double known_at,
                       std::optional<double> horizon = std::nullopt) const;
  /// What commands ask for over [start, end] and `back` [s] before, by what was known of a car at `known` [s].
  InputHistory commanded(const Segment& over, double back, double known,
                         const std::vector<InputSample>& future = {}) const;
  /// Wheel speeds that drive a model are held until the next one, as it will be driven; behind commands they say what
  /// the drive did.
  InputHistory wheels_over(double start, double end) const;
  /// The motion over a segment of which times and heading are given, with the inputs that came so far, those of the
  /// last `back` [s] before it included.
  DrivenSegment stretch(Segment segment, double back) const;
  /// The same from now on, driven by `future` inputs. What is held for longer than any input that was measured is
  /// repeated, so that there are poses on the way.
  DrivenSegment ahead(Segment segment, const std::vector<InputSample>& future) const;
  /// How the inputs of `ahead` may be else, where a car's curves make them of the commands.
  InputSpread spread_ahead(double start, double end, const std::vector<InputSample>& future) const;
  /// Known forces over what lies ahead of `start` [s]: those of late, and then the `future` ones.
  /// \throws std::invalid_argument when one is impossible, or attitudes say that the ground is not level.
  ForceBuffer forces_ahead(double start, const std::vector<KnownForce>& future) const;

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const MeasuredDrive& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.settings, self.commands, self.wheels, self.tilts, self.forces, self.readings, self.car);
  }
};

}  // namespace slipwise
