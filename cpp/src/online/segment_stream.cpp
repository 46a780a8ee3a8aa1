// SPDX-License-Identifier: Apache-2.0
// Measurements in order of time, whatever the order in which they arrive.
#include "slipwise/online/segment_stream.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <span>
#include <utility>

#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/linear/tuning.hpp"
#include "slipwise/online/learner_times.hpp"

namespace slipwise {
namespace {

constexpr double kLongestGap = 120.0;             // [s] between poses, after which the segment before it may still end
constexpr long kFramesApart = 1'000'000'000'000;  // numbers of frames before a break and after it are never the same
constexpr double kHeadings = 0.1;                 // [s] between headings of a gyro
constexpr double kMissing = 0.25;                 // [s] between its samples, over which the robot may turn otherwise
constexpr double kSpare = 10.0;                   // [s] that inputs are kept for longer than a segment may need

std::size_t index(Stream stream) { return static_cast<std::size_t>(stream); }

/// A standard deviation that can be one.
double allowed(double std) { return std >= 0.0 ? std : std::numeric_limits<double>::quiet_NaN(); }

}  // namespace

SegmentStream::SegmentStream(const StreamSettings& settings)
    : drive_(settings),
      keep_(kLookBack + kSpare + settings.latency),
      range_(settings.sensor, settings.unknown_after),
      cutters_(settings),
      courses_(settings.sensor),
      others_(settings) {
  double longest = settings.segment_length;
  for (const double horizon : settings.horizons) {
    longest = std::max(longest, horizon);
  }
  keep_ += 2.0 * longest;
}

SegmentStream::SegmentStream(const SegmentStream&) = default;
SegmentStream::SegmentStream(SegmentStream&&) noexcept = default;
SegmentStream& SegmentStream::operator=(const SegmentStream&) = default;
SegmentStream& SegmentStream::operator=(SegmentStream&&) noexcept = default;
SegmentStream::~SegmentStream() = default;

void SegmentStream::start_run() {
  end_run();
  evidence_.start_run();
  newest_ = now_ = -kNever;
  stamps_.fill({});
  speeds_ = {};
  drive_.start_run();
  turned_until_.reset();
  gate_.restart();
  timer_.restart();
  wheel_timer_.restart();
  others_.start_run();
}

void SegmentStream::end_run() {
  advance(kNever);
  process_accepted(gate_.finish(drive_.gate_inputs(now_)));
  others_.finish_gates(drive_, output_);
  cutters_.finish(drive_, wheels_ever_, now_, output_);
  others_.finish_segments(now_, drive_, output_);
  cutters_.finish_targets(drive_, now_, output_);
  range_.restart();
  evidence_.end_run(drive_.wheels);
}

/// Whether a measurement may be used; says why not.
bool SegmentStream::arrives(Stream stream, double t, std::span<const double> numbers, std::size_t kind) {
  evidence_.see_stamp(t);
  const bool too_late = std::isfinite(t) && later(newest_ - settings().latency, t);
  if (const auto wrong = stamps_[index(stream) + kind].check(t, numbers)) {
    output_.reject(stream, *wrong, t);
    return false;
  }
  if (too_late) {
    output_.reject(stream, Reason::TooLate, t);
    return false;
  }
  newest_ = std::max(newest_, t);
  return true;
}

/// `given` is the input before anything was made of it, as a car's throttle and steering.
bool SegmentStream::take_input(Stream stream, const InputSample& sample, const BodyTwist& given) {
  const auto& [v, vy, omega] = sample.twist;
  if (!arrives(stream, sample.t, std::array{v, vy, omega})) {
    return false;
  }
  auto& gates = speeds_[index(stream)];
  const bool measured = stream == Stream::Wheels;
  const std::array plausible{gates[0].plausible(v, measured), gates[1].plausible(vy, measured),
                             gates[2].plausible(omega, measured)};
  if (!std::ranges::all_of(plausible, std::identity{})) {
    output_.reject(stream, Reason::AbsurdSpeed, sample.t);
    return false;
  }
  InputBuffer& history = stream == Stream::Command ? drive_.commands : drive_.wheels;
  history.push(sample);
  if (&history == &drive_.inputs()) {
    range_.see(sample, given);
  }
  return true;
}

bool SegmentStream::push(const Measurement& measurement) {
  const bool taken = std::visit([this](const auto& sample) { return take(sample); }, measurement);
  advance(newest_ - settings().latency - kWheelsAhead);
  return taken;
}

bool SegmentStream::take(const CommandSample& command) {
  const InputSample& sample = command.sample;
  if (!drive_.car) {
    return take_input(Stream::Command, sample, sample.twist);
  }
  CarStream& car = *drive_.car;
  const bool taken = take_input(Stream::Command, {sample.t, car.expected(sample, settings().latency)}, sample.twist);
  if (taken) {
    car.push_command(sample, settings().latency);
  }
  return taken;
}

bool SegmentStream::take(const WheelSample& wheels) {
  const bool taken = take_input(Stream::Wheels, wheels.sample, wheels.sample.twist);
  if (taken) {
    wheel_stamps_.push_back(wheels.sample.t);
  }
  return taken;
}

bool SegmentStream::take(const Tilt& measured) {
  if (!arrives(Stream::Attitude, measured.t, std::array{measured.roll, measured.pitch})) {
    return false;
  }
  const std::optional<Tilt> tilt = attitudes_.level(measured);
  if (!tilt) {
    output_.reject(Stream::Attitude, Reason::SteepAttitude, measured.t);
    return false;
  }
  drive_.tilts.push(*tilt);
  range_.see(*tilt);
  return true;
}

bool SegmentStream::take(const KnownForce& force) {
  if (!arrives(Stream::Force, force.t, std::array{force.x, force.y})) {
    return false;
  }
  if (!drive_.tilts.empty()) {
    output_.reject(Stream::Force, Reason::ForceBesideAttitude, force.t);
    return false;
  }
  drive_.forces.push(force);
  return true;
}

bool SegmentStream::take(const Reading& reading) {
  if (!arrives(Stream::Reading, reading.t, std::array{reading.value}, reading.kind)) {
    return false;
  }
  drive_.readings.push(reading);
  if (Readings::of_gyro(reading)) {
    const TimedNumber rate{reading.t, reading.value};
    evidence_.push_gyro(rate);
    if (settings().heading_only) {
      turn_on(rate);
    }
  }
  return true;
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

bool SegmentStream::take(const MeasuredPose& pose) {
  evidence_.see_stamp(pose.t);
  if (pose.fix == PoseFix::None) {
    output_.reject(Stream::Pose, Reason::NoFix, pose.t);
    return false;
  }
  if (pose.source == 0) {
    return take_first(pose);
  }
  const std::optional<double> stamp = others_.push(pose, newest_ - settings().latency, output_);
  newest_ = std::max(newest_, stamp.value_or(newest_));
  return stamp.has_value();
}

bool SegmentStream::take_first(const MeasuredPose& pose) {
  const double yaw = pose.position ? 0.0 : pose.yaw;
  const std::array numbers{pose.x, pose.y, yaw, allowed(pose.std.xy), allowed(pose.std.yaw)};
  const bool taken = arrives(Stream::Pose, pose.t, numbers);
  if (taken && pose.learned && pose.position != position_last_) {
    ++breaks_;
    position_last_ = pose.position;
  }
  if (taken && pose.learned) {
    poses_.push_back(pose);
    poses_.back().yaw = yaw;
    poses_.back().frame += kFramesApart * breaks_;
  } else if (taken && learned_last_) {
    ++breaks_;
  }
  learned_last_ = taken ? pose.learned : learned_last_;
  return taken;
}

/// Uses what cannot be preceded any more.
void SegmentStream::advance(double until) {
  while (!poses_.empty() && poses_.front().t <= until) {
    const MeasuredPose pose = poses_.front();
    poses_.pop_front();
    others_.advance(pose.t, drive_, output_);
    process_wheels(pose.t);
    process_pose(pose);
  }
  others_.advance(until, drive_, output_);
  process_wheels(until);
  evidence_.compare_gyro(until, drive_.commands, drive_.wheels);
  trim();
}

/// Wheel speeds end segments of their own, from which the actuator model is learned.
void SegmentStream::process_wheels(double until) {
  while (!wheel_stamps_.empty() && wheel_stamps_.front() <= until) {
    const double t = wheel_stamps_.front();
    wheel_stamps_.pop_front();
    wheels_ever_ = true;
    const auto timed = wheel_timer_.push({.t = t, .x = 0.0, .y = 0.0, .yaw = 0.0}, settings().rules.late_factor);
    if (timed && settings().from_commands) {
      cutters_.push_wheels(*timed, drive_, output_);
    }
  }
}

void SegmentStream::process_pose(const MeasuredPose& raw) {
  now_ = raw.t;
  const MeasuredPose pose = drive_.complete(raw, accuracy_);
  if (settings().heading_only) {
    process_accepted({.accepted = {pose}, .outliers = {}, .jumps = {}});
  } else {
    evidence_.see_measured(raw, drive_.commands, drive_.wheels);
    process_accepted(gate_.push(pose, drive_.gate_inputs(now_)));
  }
}

/// Gives a position the heading that the inputs and the positions of late make, where they make one.
bool SegmentStream::head(TimedPose& timed, CourseFinder& courses) const {
  if (timed.pose.position) {
    const auto yaw = courses.push(timed.pose, drive_.gate_inputs(timed.pose.t));
    timed.pose.yaw = yaw.value_or(timed.pose.yaw);
    return yaw.has_value();
  }
  return true;
}

void SegmentStream::process_accepted(const GatedPoses& gated) {
  output_.reject(gated);
  if (!settings().heading_only) {
    evidence_.see_gated(gated, drive_.commands, drive_.wheels);
  }
  for (const MeasuredPose& pose : gated.accepted) {
    auto timed = timer_.push(pose, settings().rules.late_factor);
    if (!timed) {
      output_.reject(Stream::Pose, Reason::LatePose, pose.t);
      continue;
    }
    drive_.readings.gyro().see_inputs(pose.t, drive_.gate_inputs(pose.t), settings().rules.still_speed);
    if (head(*timed, courses_)) {
      heading_ = timed->pose.yaw;
      range_.see(timed->pose);
      if (pose.position) {
        drive_.readings.gyro().see_course(timed->pose);
      }
      if (drive_.car) {
        drive_.car->push_pose(timed->pose);
      }
    }
    cutters_.push(*timed, drive_, wheels_ever_, now_, output_);
  }
}

/// Inputs are kept for segments that have begun, unless poses do not come for long.
void SegmentStream::trim() {
  double begun = std::max(now_, newest_ - settings().latency);
  begun = others_.begins(cutters_.begins(begun));
  drive_.drop_before(std::max(begun, newest_ - settings().latency - kLongestGap) - keep_);
}

std::vector<DrivenSegment> SegmentStream::pending_segments() const {
  PoseAccuracies accuracy = accuracy_;
  PoseGate gate = gate_;
  PoseTimer timer = timer_;
  SegmentCutter cutter = cutters_.learned();
  std::vector<DrivenSegment> found;
  for (const MeasuredPose& raw : poses_) {
    for (const MeasuredPose& pose : gate.push(drive_.complete(raw, accuracy), drive_.gate_inputs(raw.t)).accepted) {
      const auto timed = timer.push(pose, settings().rules.late_factor);
      if (!timed) {
        continue;
      }
      for (const SegmentCut& cut : drive_.fitted(cutter.push(*timed, drive_.inputs()), settings().sensor)) {
        if (!cut.rejected) {
          found.push_back(drive_.driven(cut, !settings().from_commands, raw.t));
        }
      }
    }
  }
  return found;
}

Segment SegmentStream::over(double start, double end) const {
  return {.start = start, .end = end, .measured = measured_pose({}, settings().sensor), .heading = heading_};
}

std::vector<StreamItem> SegmentStream::take_items() { return std::exchange(output_.items, {}); }

std::vector<Rejected> SegmentStream::take_rejected() { return std::exchange(output_.rejected, {}); }

}  // namespace slipwise
