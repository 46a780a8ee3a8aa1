// SPDX-License-Identifier: Apache-2.0
// Segments of a stream that a caller asks for: those that are complete now, and those ahead.
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "slipwise/online/learner_times.hpp"
#include "slipwise/online/segment_stream.hpp"

namespace slipwise {
namespace {

constexpr double kLargestForce = 1e3;  // [m/s^2]

}  // namespace

std::vector<DrivenSegment> SegmentStream::pending_segments() const {
  PoseAccuracies accuracy = accuracy_;
  PoseGate gate = gate_;
  PoseTimer timer = timer_;
  ChordFinder chords = chords_;
  SegmentCutter cutter = learned_;
  std::vector<DrivenSegment> found;
  for (const MeasuredPose& raw : poses_) {
    for (const MeasuredPose& pose : gate.push(complete(raw, accuracy), gate_inputs(raw.t)).accepted) {
      auto timed = timer.push(pose, settings_.rules.late_factor);
      if (timed) {
        timed = headed(*std::move(timed), chords);
      }
      for (const SegmentCut& cut : timed ? cutter.push(*timed, inputs()) : std::vector<SegmentCut>{}) {
        if (!cut.rejected) {
          found.push_back(driven(cut, !settings_.from_commands, raw.t));
        }
      }
    }
  }
  return found;
}

std::vector<InputSample> SegmentStream::repeated(const std::vector<InputSample>& future, double end) const {
  std::vector<InputSample> all;
  std::optional<BodyTwist> held = given().known_at(newest_);
  double since = newest_;
  const auto repeat_until = [&](double t) {
    double next = since + settings_.unknown_after;
    while (held && next < t) {
      all.push_back({next, *held});
      next += settings_.unknown_after;
    }
  };
  for (const InputSample& sample : future) {
    repeat_until(std::min(sample.t, end));
    all.push_back(sample);
    held = sample.twist;
    since = std::max(sample.t, newest_);
  }
  repeat_until(end);
  return all;
}

DrivenSegment SegmentStream::segment_ahead(double horizon, const std::vector<InputSample>& future) const {
  Segment segment{.start = newest_, .end = newest_ + horizon, .sensor = settings_.sensor, .heading = heading_};
  stand_on_ground(segment, true);
  const bool by_wheels = !settings_.from_commands;
  if (!by_wheels) {
    set_actuator_state(segment);
  }
  const std::vector<InputSample> all = repeated(future, segment.end);
  InputHistory driving = by_wheels ? wheels_.slice(segment.start - kWheelsBack, segment.end, SliceKind::Wheels, all)
                                   : commanded(segment, kLookBack, newest_, all);
  return {.inputs = std::move(driving), .segment = std::move(segment), .known_at = newest_};
}

ForceBuffer SegmentStream::forces_ahead(const std::vector<KnownForce>& future) const {
  ForceBuffer forces = forces_;
  double before = newest_;
  for (const KnownForce& force : future) {
    const double most = std::max(std::abs(force.x), std::abs(force.y));
    if (!(force.t > before) || !std::isfinite(force.t) || !(most <= kLargestForce)) {
      throw std::invalid_argument(
          "future forces must be finite, in m/s^2, and their stamps increase from the newest measurement on");
    }
    before = force.t;
    forces.push(force);
  }
  if (!future.empty() && tilts_.from(newest_, settings_.unknown_after)) {
    throw std::invalid_argument("a known force acts on level ground alone, and attitudes were pushed");
  }
  return forces;
}

InputSpread SegmentStream::spread_ahead(double horizon, const std::vector<InputSample>& future) const {
  const double end = newest_ + horizon;
  return car_ && settings_.from_commands ? car_->spread(newest_, end, newest_, repeated(future, end)) : InputSpread{};
}

DrivenSegment SegmentStream::stretch(double start, double end, double back) const {
  Segment segment{.start = start, .end = end, .sensor = settings_.sensor, .heading = heading_};
  stand_on_ground(segment, false);
  if (settings_.from_commands) {
    set_actuator_state(segment);
  }
  const double before = std::min(back, kLookBack);
  InputHistory driving = settings_.from_commands ? commanded(segment, before, start)
                                                 : wheels_.slice(start - before, end, SliceKind::Wheels);
  return {.inputs = std::move(driving), .segment = std::move(segment), .known_at = end};
}

}  // namespace slipwise
