// SPDX-License-Identifier: Apache-2.0
// What is pushed beside inputs and poses of the first source: attitudes, forces, readings, and poses of other sources,
// in the order of their stamps, gated, and cut into segments.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/linear/tuning.hpp"
#include "slipwise/online/learner_times.hpp"
#include "slipwise/online/segment_stream.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kStarts, 10.0);  // segments begin this many times within the length of one, so that gaps are filled

}  // namespace

void SegmentStream::begin_others() {
  for (std::size_t i = 1; i < settings_.sources.size(); ++i) {
    const SourceSettings& source = settings_.sources[i];
    others_.push_back({.settings = source,
                       .cutter = SegmentCutter(settings_.segment_length, settings_.rules, false,
                                               settings_.segment_length / kStarts)});
  }
}

/// It is used `kClocksApart` after its stamp, so that inputs are known whenever it really was.
bool SegmentStream::take_other(MeasuredPose pose) {
  if (pose.source > others_.size()) {
    reject(Stream::Pose, Reason::NotFinite, pose.t);
    return false;
  }
  PoseSource& source = others_[pose.source - 1];
  pose.t -= source.settings.late;
  pose.yaw = pose.position ? 0.0 : pose.yaw;
  const bool absurd = !(pose.std.xy >= 0.0) || !(pose.std.yaw >= 0.0);
  if (absurd || later(newest_ - settings_.latency, pose.t)) {
    reject(Stream::Pose, absurd ? Reason::NotFinite : Reason::TooLate, pose.t);
    return false;
  }
  if (!pose.learned) {
    ++source.breaks;
    return true;
  }
  if (const auto wrong = source.take(pose)) {
    reject(Stream::Pose, *wrong, pose.t);
    return false;
  }
  newest_ = std::max(newest_, pose.t);
  return true;
}

/// Uses what cannot be preceded any more, the earliest first.
void SegmentStream::advance_others(double until) {
  const auto next = [](const PoseSource& source) {
    return source.waiting.empty() ? std::numeric_limits<double>::infinity() : source.waiting.front().t + kClocksApart;
  };
  while (!others_.empty()) {
    PoseSource& source = *std::ranges::min_element(others_, {}, next);
    if (source.waiting.empty() || later(next(source), until)) {
      return;
    }
    const MeasuredPose raw = source.waiting.front();
    source.waiting.pop_front();
    source.used = raw.t;
    process_other(source, source.gate.push(complete(raw, source.accuracies), gate_inputs(raw.t)), raw.t + kClocksApart);
  }
}

void SegmentStream::finish_others() {
  for (PoseSource& source : others_) {
    process_other(source, source.gate.finish(gate_inputs(source.used)), source.used + kClocksApart);
  }
}

void SegmentStream::process_other(PoseSource& source, const GatedPoses& gated, double known_at) {
  reject_gated(gated);
  for (const MeasuredPose& pose : gated.accepted) {
    auto timed = source.timer.push(pose, settings_.rules.late_factor);
    if (!timed) {
      reject(Stream::Pose, Reason::LatePose, pose.t);
      continue;
    }
    for (const SegmentCut& cut : fitted(source.cutter.push(*timed, inputs()), source.settings.sensor)) {
      emit_other(source, cut, known_at);
    }
  }
}

/// Stretches without use are counted for the first source alone: those of others overlap.
void SegmentStream::emit_other(const PoseSource& source, const SegmentCut& cut, double known_at) {
  if (cut.rejected) {
    return;
  }
  DrivenSegment found = driven(cut, !settings_.from_commands, known_at);
  Segment& segment = found.segment;
  for (auto& [sensor, z] : segment.measured) {
    sensor.number = cut.first.source;
    sensor.place = source.settings.sensor;
    sensor.calibrated = true;
  }
  Segment longer = segment;
  longer.end += kClocksApart;
  found.inputs = settings_.from_commands ? commanded(longer, kLookBack, segment.start)
                                         : wheels(path_start(segment) - kWheelsBack, longer.end);
  items_.emplace_back(SourceSegment{std::move(found), cut.first.source, classes_of(cut)});
}

bool SegmentStream::push(const Measurement& measurement) {
  const bool taken = std::visit([this](const auto& sample) { return take(sample); }, measurement);
  advance(newest_ - settings_.latency);
  return taken;
}

bool SegmentStream::take(const Tilt& measured) {
  if (!arrives(Stream::Attitude, measured.t, std::array{measured.roll, measured.pitch})) {
    return false;
  }
  const std::optional<Tilt> tilt = attitudes_.level(measured);
  if (!tilt) {
    reject(Stream::Attitude, Reason::SteepAttitude, measured.t);
    return false;
  }
  tilts_.push(*tilt);
  steepest_ = std::max({steepest_, std::abs(tilt->roll), std::abs(tilt->pitch)});
  return true;
}

bool SegmentStream::take(const KnownForce& force) {
  if (!arrives(Stream::Force, force.t, std::array{force.x, force.y})) {
    return false;
  }
  if (!tilts_.empty()) {
    reject(Stream::Force, Reason::ForceBesideAttitude, force.t);
    return false;
  }
  forces_.push(force);
  return true;
}

bool SegmentStream::take(const Reading& reading) {
  if (!arrives(Stream::Reading, reading.t, std::array{reading.value}, reading.kind)) {
    return false;
  }
  readings_.push(reading);
  if (Readings::of_gyro(reading)) {
    const TimedNumber rate{reading.t, reading.value};
    evidence_.push_gyro(rate);
    if (settings_.heading_only) {
      turn_on(rate);
    }
  }
  return true;
}

}  // namespace slipwise
