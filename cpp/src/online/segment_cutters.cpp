// SPDX-License-Identifier: Apache-2.0
// What cutters cut, handed out as segments with their inputs.
#include "slipwise/online/segment_cutters.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "slipwise/linear/tuning.hpp"
#include "slipwise/online/learner_times.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kSlipLength, 1.0);     // [s] of segments behind wheel speeds
SLIPWISE_TUNING(kOfPositions, 5.0);    // [s] of those between positions, which tell together how they turn
SLIPWISE_TUNING(kWheelLength, 1.0);    // [s] wheel speeds tell a step's response from its start on
constexpr double kActuatorBack = 5.0;  // [s] of commands before wheel speeds; their filter goes on from there

SegmentRules between_positions(SegmentRules rules, double length) {
  rules.of_positions = length;
  return rules;
}

void see_noise(const std::vector<SegmentCut>& cuts, SegmentCutter& cutter) {
  for (const SegmentCut& cut : cuts) {
    if (cut.fitted) {
      cutter.see_noise(cut.fitted->std);
    }
  }
}

void emit_wheel_segments(const std::vector<SegmentCut>& cuts, const MeasuredDrive& drive, StreamOutput& out) {
  for (const SegmentCut& cut : cuts) {
    if (!cut.rejected) {
      // A stretch ends where its last wheel speed begins: for how long that one stands, only the next one says.
      const double start = drive.wheels.measured_since(cut.first.t);
      const double end = drive.wheels.measured_since(cut.second.t);
      out.items.emplace_back(
          WheelSegment{.commands = drive.commanded({.start = start, .end = end}, kActuatorBack, start),
                       .wheels = drive.wheels_over(start, end),
                       .start = start,
                       .end = end,
                       .known_at = cut.second.t});
    }
  }
}

void emit_slip(const std::vector<SegmentCut>& cuts, const MeasuredDrive& drive, double now, StreamOutput& out) {
  for (const SegmentCut& cut : cuts) {
    if (!cut.rejected) {
      out.items.emplace_back(SlipSegment{drive.driven(cut, true, now)});
    }
  }
}

void emit_twists(const std::vector<TwistStretch>& stretches, const MeasuredDrive& drive, StreamOutput& out) {
  for (const TwistStretch& stretch : stretches) {
    out.items.emplace_back(TwistSegment{
        {.commands = drive.commanded({.start = stretch.start, .end = stretch.end}, kActuatorBack, stretch.start),
         .wheels = InputHistory(stretch.t, stretch.twist),
         .start = stretch.start,
         .end = stretch.end}});
  }
}

void emit_learned(const std::vector<SegmentCut>& cuts, const MeasuredDrive& drive, double now, StreamOutput& out) {
  for (const SegmentCut& cut : cuts) {
    if (cut.rejected) {
      out.reject(Stream::Pose, *cut.rejected, cut.first.t);
    } else if (drive.settings.sources.empty()) {
      out.items.emplace_back(drive.driven(cut, !drive.settings.from_commands, now));
    } else {
      out.items.emplace_back(SourceSegment{drive.driven(cut, !drive.settings.from_commands, now), 0, classes_of(cut)});
    }
  }
}

void emit_targets(std::size_t horizon, const std::vector<SegmentCut>& cuts, const MeasuredDrive& drive, double now,
                  StreamOutput& out) {
  for (const SegmentCut& cut : cuts) {
    if (!cut.rejected) {
      const double length = drive.settings.horizons[horizon];
      TargetSegment target{horizon, drive.driven(cut, !drive.settings.from_commands, now, length)};
      if (drive.car && drive.settings.from_commands) {
        const double known = cut.first.t - std::max(length, kReady);
        target.baseline = drive.car->baseline(cut.first.t, cut.second.t, known);
        target.spread = drive.car->spread(path_start(target.driven.segment), cut.second.t, known);
      }
      target.classes = classes_of(cut);
      out.items.emplace_back(std::move(target));
    }
  }
}

}  // namespace

SegmentCutters::SegmentCutters(const StreamSettings& settings)
    : learned_(settings.segment_length, between_positions(settings.rules, settings.segment_length),
               settings.whole_frames, settings.stride),
      slip_(kSlipLength, between_positions(settings.rules, kOfPositions), true),
      wheels_(kWheelLength, settings.rules, true),
      twists_(settings.rules, settings.sensor) {
  for (const double horizon : settings.horizons) {
    targets_.emplace_back(horizon, settings.rules, false);
  }
}

void SegmentCutters::push(const TimedPose& timed, const MeasuredDrive& drive, bool wheels_known, double now,
                          StreamOutput& out) {
  const StreamSettings& settings = drive.settings;
  if (settings.from_commands && wheels_known) {
    const std::vector<SegmentCut> cuts = drive.fitted(slip_.push(timed, drive.wheels), settings.sensor);
    see_noise(cuts, slip_);
    emit_slip(cuts, drive, now, out);
  } else if (settings.from_commands && !timed.pose.position && !settings.heading_only) {
    emit_twists(twists_.push(timed, drive.commands), drive, out);  // a course lags behind the heading by half its way
  }
  const std::vector<SegmentCut> cuts = drive.fitted(learned_.push(timed, drive.inputs()), settings.sensor);
  see_noise(cuts, learned_);
  emit_learned(cuts, drive, now, out);
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    emit_targets(i, drive.fitted(targets_[i].push(timed, drive.inputs()), settings.sensor), drive, now, out);
  }
}

void SegmentCutters::push_wheels(const TimedPose& timed, const MeasuredDrive& drive, StreamOutput& out) {
  emit_wheel_segments(wheels_.push(timed, drive.commands), drive, out);
}

void SegmentCutters::finish(const MeasuredDrive& drive, bool wheels_known, double now, StreamOutput& out) {
  if (drive.settings.from_commands) {
    emit_wheel_segments(wheels_.finish(drive.commands), drive, out);
    emit_twists(twists_.finish(drive.commands), drive, out);
    if (wheels_known) {
      const std::vector<SegmentCut> cuts = drive.fitted(slip_.finish(drive.wheels), drive.settings.sensor);
      see_noise(cuts, slip_);
      emit_slip(cuts, drive, now, out);
    }
  }
  const std::vector<SegmentCut> cuts = drive.fitted(learned_.finish(drive.inputs()), drive.settings.sensor);
  see_noise(cuts, learned_);
  emit_learned(cuts, drive, now, out);
}

void SegmentCutters::finish_targets(const MeasuredDrive& drive, double now, StreamOutput& out) {
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    emit_targets(i, drive.fitted(targets_[i].finish(drive.inputs()), drive.settings.sensor), drive, now, out);
  }
}

double SegmentCutters::begins(double begun) const {
  begun = std::min(begun, twists_.begins());
  for (const SegmentCutter* cutter : {&learned_, &slip_, &wheels_}) {
    begun = std::min(begun, cutter->begins());
  }
  for (const SegmentCutter& cutter : targets_) {
    begun = std::min(begun, cutter.begins());
  }
  return begun;
}

}  // namespace slipwise
