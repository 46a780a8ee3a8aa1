// SPDX-License-Identifier: Apache-2.0
// What cutters cut, handed out as segments, positions with their heading; those that a caller asks for: complete now,
// and ahead.
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/learner_times.hpp"
#include "slipwise/online/segment_stream.hpp"

namespace slipwise {
namespace {

constexpr double kHeadings = 0.1;      // [s] between headings of a gyro
constexpr double kMissing = 0.25;      // [s] between samples of a gyro, over which the robot may have turned otherwise
constexpr double kUnknownTurn = 3.0;   // [rad] of a turn that a gyro did not see
constexpr double kActuatorBack = 5.0;  // [s] of commands before wheel speeds; their filter goes on from the last
constexpr double kLargestForce = 1e3;  // [m/s^2] that a caller may expect

void see_noise(const std::vector<SegmentCut>& cuts, SegmentCutter& cutter) {
  for (const SegmentCut& cut : cuts) {
    if (cut.fitted) {
      cutter.see_noise(cut.fitted->std);
    }
  }
}

/// What a car does by the curves that are known at the end.
InputBuffer by_curves(const CarStream& car, double start, double end) {
  const InputHistory twists = car.inputs(start, end, end);
  InputBuffer found(std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < twists.size(); ++i) {
    found.push({twists.time(i), twists.sample(i)});
  }
  return found;
}

}  // namespace

/// Gives a position the heading that the inputs and the positions of late make, where they make one.
bool SegmentStream::head(TimedPose& timed, CourseFinder& courses) const {
  if (timed.pose.position) {
    const auto yaw = courses.push(timed.pose, gate_inputs(timed.pose.t));
    timed.pose.yaw = yaw.value_or(timed.pose.yaw);
    return yaw.has_value();
  }
  return true;
}

/// Segments between positions with what all these tell of the motion; those of which they tell no course are rejected.
std::vector<SegmentCut> SegmentStream::fitted(std::vector<SegmentCut> cuts, const Pose2& place) const {
  for (SegmentCut& cut : cuts) {
    if (cut.first.position && !cut.rejected) {
      const InputBuffer& best = gate_inputs(cut.first.t);
      const InputBuffer& way = best.unknown_since(cut.first.t, cut.second.t) ? inputs() : best;
      const bool curves = car_ && &way == &commands_;
      cut.fitted = curves
                       ? fit_positions(cut.positions, cut.second.t, by_curves(*car_, cut.first.t, cut.second.t), place)
                       : fit_positions(cut.positions, cut.second.t, way, place);
      cut.rejected = cut.fitted ? cut.rejected : std::optional(Reason::NoCourse);
    }
  }
  return cuts;
}

/// Headings are integrals of a gyro, one every `kHeadings`, and a frame ends where samples are missing.
void SegmentStream::turn_on(const TimedNumber& sample) {
  if (turned_until_) {
    const double seconds = sample.t - turned_until_->t;
    breaks_ += later(seconds, kMissing) ? 1 : 0;
    turned_ += 0.5 * seconds * (sample.value + turned_until_->value);
  }
  turned_until_ = sample;
  if (!later((poses_.empty() ? now_ : poses_.back().t) + kHeadings, sample.t)) {
    poses_.push_back({.t = sample.t, .x = 0.0, .y = 0.0, .yaw = turned_, .frame = breaks_});
  }
}

/// The turn alone, by a gyro whose bias is known as far as it is when the segment is complete.
void SegmentStream::set_turn(Segment& segment) const {
  const GyroTurn turn =
      readings_.gyro().turn(segment.start, segment.end).value_or(GyroTurn{rows_of(segment.measured)[2], kUnknownTurn});
  segment.measured = {measured_turn(turn)};
}

void SegmentStream::reject_gated(const GatedPoses& gated) {
  for (const MeasuredPose& pose : gated.outliers) {
    reject(Stream::Pose, Reason::PoseOutlier, pose.t);
  }
  for (const MeasuredPose& pose : gated.jumps) {
    reject(Stream::Pose, Reason::PoseJump, pose.t);
  }
}

void SegmentStream::emit_wheel_segments(const std::vector<SegmentCut>& cuts) {
  for (const SegmentCut& cut : cuts) {
    if (!cut.rejected) {
      // A stretch ends where its last wheel speed begins: for how long that one stands, only the next one says.
      const double start = wheels_.measured_since(cut.first.t);
      const double end = wheels_.measured_since(cut.second.t);
      items_.emplace_back(WheelSegment{.commands = commanded({.start = start, .end = end}, kActuatorBack, start),
                                       .wheels = wheels(start, end),
                                       .start = start,
                                       .end = end,
                                       .known_at = cut.second.t});
    }
  }
}

void SegmentStream::emit_slip(const std::vector<SegmentCut>& cuts) {
  see_noise(cuts, slip_);
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
  see_noise(cuts, learned_);
  for (const SegmentCut& cut : cuts) {
    if (cut.rejected) {
      reject(Stream::Pose, *cut.rejected, cut.first.t);
    } else if (settings_.sources.empty()) {
      items_.emplace_back(driven(cut, !settings_.from_commands, now_));
    } else {
      items_.emplace_back(SourceSegment{driven(cut, !settings_.from_commands, now_), 0, classes_of(cut)});
    }
  }
}

void SegmentStream::emit_targets(std::size_t horizon, const std::vector<SegmentCut>& cuts) {
  for (const SegmentCut& cut : cuts) {
    if (!cut.rejected) {
      const double length = settings_.horizons[horizon];
      TargetSegment target{horizon, driven(cut, !settings_.from_commands, now_, length)};
      if (car_ && settings_.from_commands) {
        const double known = cut.first.t - std::max(length, kReady);
        target.baseline = car_->baseline(cut.first.t, cut.second.t, known);
        target.spread = car_->spread(path_start(target.driven.segment), cut.second.t, known);
      }
      target.classes = classes_of(cut);
      items_.emplace_back(std::move(target));
    }
  }
}

std::vector<DrivenSegment> SegmentStream::pending_segments() const {
  PoseAccuracies accuracy = accuracy_;
  PoseGate gate = gate_;
  PoseTimer timer = timer_;
  SegmentCutter cutter = learned_;
  std::vector<DrivenSegment> found;
  for (const MeasuredPose& raw : poses_) {
    for (const MeasuredPose& pose : gate.push(complete(raw, accuracy), gate_inputs(raw.t)).accepted) {
      const auto timed = timer.push(pose, settings_.rules.late_factor);
      if (!timed) {
        continue;
      }
      for (const SegmentCut& cut : fitted(cutter.push(*timed, inputs()), settings_.sensor)) {
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
  Segment segment{
      .start = newest_, .end = newest_ + horizon, .measured = measured_pose({}, settings_.sensor), .heading = heading_};
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
  Segment segment{.start = start, .end = end, .measured = measured_pose({}, settings_.sensor), .heading = heading_};
  stand_on_ground(segment, false);
  if (settings_.from_commands) {
    set_actuator_state(segment);
  }
  const double before = std::min(back, kLookBack);
  InputHistory driving = settings_.from_commands ? commanded(segment, before, start) : wheels(start - before, end);
  return {.inputs = std::move(driving), .segment = std::move(segment), .known_at = end};
}

}  // namespace slipwise
