// SPDX-License-Identifier: Apache-2.0
// Sources take turns by the stamps of what waits; their segments overlap, so that gaps of the first are filled.
#include "slipwise/online/pose_sources.hpp"

#include <algorithm>
#include <utility>

#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/linear/tuning.hpp"
#include "slipwise/online/learner_times.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kStarts, 10.0);  // segments begin this many times within the length of one, so that gaps are filled

/// Stretches without use are counted for the first source alone: those of others overlap.
void emit(const PoseSource& source, const SegmentCut& cut, double known_at, const MeasuredDrive& drive,
          StreamOutput& out) {
  if (cut.rejected) {
    return;
  }
  const bool from_commands = drive.settings.from_commands;
  DrivenSegment found = drive.driven(cut, !from_commands, known_at);
  Segment& segment = found.segment;
  for (auto& [sensor, z] : segment.measured) {
    sensor.number = cut.first.source;
    sensor.place = source.settings.sensor;
    sensor.calibrated = true;
  }
  Segment longer = segment;
  longer.end += kClocksApart;
  found.inputs = from_commands ? drive.commanded(longer, kLookBack, segment.start)
                               : drive.wheels_over(path_start(segment) - kWheelsBack, longer.end);
  out.items.emplace_back(SourceSegment{std::move(found), cut.first.source, classes_of(cut)});
}

}  // namespace

PoseSources::PoseSources(const StreamSettings& settings) {
  for (std::size_t i = 1; i < settings.sources.size(); ++i) {
    sources_.push_back(
        {.settings = settings.sources[i],
         .cutter = SegmentCutter(settings.segment_length, settings.rules, false, settings.segment_length / kStarts)});
  }
}

void PoseSources::start_run() { std::ranges::for_each(sources_, &PoseSource::restart); }

std::optional<double> PoseSources::push(MeasuredPose pose, double oldest, StreamOutput& out) {
  if (pose.source > sources_.size()) {
    out.reject(Stream::Pose, Reason::NotFinite, pose.t);
    return std::nullopt;
  }
  PoseSource& source = sources_[pose.source - 1];
  pose.t -= source.settings.late;
  pose.yaw = pose.position ? 0.0 : pose.yaw;
  const bool absurd = !(pose.std.xy >= 0.0) || !(pose.std.yaw >= 0.0);
  if (absurd || later(oldest, pose.t)) {
    out.reject(Stream::Pose, absurd ? Reason::NotFinite : Reason::TooLate, pose.t);
    return std::nullopt;
  }
  if (!pose.learned) {
    ++source.breaks;
    return -kNever;
  }
  if (const auto wrong = source.take(pose)) {
    out.reject(Stream::Pose, *wrong, pose.t);
    return std::nullopt;
  }
  return pose.t;
}

void PoseSources::advance(double until, const MeasuredDrive& drive, StreamOutput& out) {
  const auto next = [](const PoseSource& source) {
    return source.waiting.empty() ? kNever : source.waiting.front().t + kClocksApart;
  };
  while (!sources_.empty()) {
    PoseSource& source = *std::ranges::min_element(sources_, {}, next);
    if (source.waiting.empty() || later(next(source), until)) {
      return;
    }
    const MeasuredPose raw = source.waiting.front();
    source.waiting.pop_front();
    source.used = raw.t;
    process(source, source.gate.push(drive.complete(raw, source.accuracies), drive.gate_inputs(raw.t)),
            raw.t + kClocksApart, drive, out);
  }
}

void PoseSources::finish_gates(const MeasuredDrive& drive, StreamOutput& out) {
  for (PoseSource& source : sources_) {
    process(source, source.gate.finish(drive.gate_inputs(source.used)), source.used + kClocksApart, drive, out);
  }
}

void PoseSources::finish_segments(double now, const MeasuredDrive& drive, StreamOutput& out) {
  for (PoseSource& source : sources_) {
    for (const SegmentCut& cut : drive.fitted(source.cutter.finish(drive.inputs()), source.settings.sensor)) {
      emit(source, cut, std::max(now, cut.second.t), drive, out);
    }
  }
}

void PoseSources::process(PoseSource& source, const GatedPoses& gated, double known_at, const MeasuredDrive& drive,
                          StreamOutput& out) {
  out.reject(gated);
  for (const MeasuredPose& pose : gated.accepted) {
    auto timed = source.timer.push(pose, drive.settings.rules.late_factor);
    if (!timed) {
      out.reject(Stream::Pose, Reason::LatePose, pose.t);
      continue;
    }
    for (const SegmentCut& cut : drive.fitted(source.cutter.push(*timed, drive.inputs()), source.settings.sensor)) {
      emit(source, cut, known_at, drive, out);
    }
  }
}

double PoseSources::begins(double begun) const {
  for (const PoseSource& source : sources_) {
    begun = std::min({begun, source.cutter.begins(), source.waiting.empty() ? begun : source.waiting.front().t});
  }
  return begun;
}

}  // namespace slipwise
