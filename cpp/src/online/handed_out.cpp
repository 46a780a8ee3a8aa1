// SPDX-License-Identifier: Apache-2.0
// What cutters cut, handed out as segments; positions get their heading first.
#include <algorithm>
#include <optional>
#include <utility>

#include "slipwise/online/learner_times.hpp"
#include "slipwise/online/segment_stream.hpp"

namespace slipwise {
namespace {

constexpr double kActuatorBack = 5.0;  // [s] of commands before wheel speeds; their filter goes on from the last

}  // namespace

/// A pose as it is; a position with the heading that its course makes, where it has one.
std::optional<TimedPose> SegmentStream::headed(TimedPose timed, ChordFinder& chords) const {
  if (timed.pose.position) {
    const auto found = chords.push(timed.pose, gate_inputs(timed.pose.t));
    if (!found) {
      return std::nullopt;
    }
    timed.pose = *found;
  }
  return timed;
}

/// What a segment between positions is measured by: chords, and the turn of a gyro where there is one.
void SegmentStream::set_course(Segment& segment, const SegmentCut& cut) const {
  const auto& first = cut.first.headings[0];
  const auto& second = cut.second.headings[0];
  if (!first || !second) {
    return;
  }
  segment.chords = {first->chord, second->chord};
  if (const auto turn = gyro_.turn(segment.start, segment.end)) {
    segment.measured.theta = turn->angle;
    segment.gyro_std = turn->std;
  }
}

void SegmentStream::emit_wheel_segments(const std::vector<SegmentCut>& cuts) {
  for (const SegmentCut& cut : cuts) {
    if (!cut.rejected) {
      const double start = cut.first.t;
      const double end = cut.second.t;
      items_.emplace_back(WheelSegment{.commands = commanded({.start = start, .end = end}, kActuatorBack, start),
                                       .wheels = wheels_.slice(start, end, SliceKind::Wheels),
                                       .start = start,
                                       .end = end});
    }
  }
}

void SegmentStream::emit_slip(const std::vector<SegmentCut>& cuts) {
  for (const SegmentCut& cut : cuts) {
    if (!cut.rejected) {
      items_.emplace_back(SlipSegment{driven(cut, true, now_)});
    }
  }
}

void SegmentStream::emit_twists(const std::vector<TwistStretch>& stretches) {
  for (const TwistStretch& stretch : stretches) {
    items_.emplace_back(
        TwistSegment{{.commands = commanded({.start = stretch.start, .end = stretch.end}, kActuatorBack, stretch.start),
                      .wheels = InputHistory(stretch.t, stretch.twist),
                      .start = stretch.start,
                      .end = stretch.end}});
  }
}

void SegmentStream::emit_learned(const std::vector<SegmentCut>& cuts) {
  for (const SegmentCut& cut : cuts) {
    if (cut.rejected) {
      reject(Stream::Pose, *cut.rejected, cut.first.t);
    } else {
      items_.emplace_back(driven(cut, !settings_.from_commands, now_));
    }
  }
}

void SegmentStream::emit_targets(std::size_t horizon, const std::vector<SegmentCut>& cuts) {
  for (const SegmentCut& cut : cuts) {
    if (!cut.rejected) {
      const double length = settings_.horizons[horizon];
      TargetSegment target{horizon, driven(cut, !settings_.from_commands, now_, length)};
      if (car_ && settings_.from_commands) {
        target.baseline = car_->baseline(cut.first.t, cut.second.t, cut.first.t - std::max(length, kReady));
      }
      items_.emplace_back(std::move(target));
    }
  }
}

}  // namespace slipwise
