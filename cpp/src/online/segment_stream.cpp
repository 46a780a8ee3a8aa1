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

SLIPWISE_TUNING(kSlipLength, 1.0);                // [s] of segments behind wheel speeds
SLIPWISE_TUNING(kOfPositions, 5.0);               // [s] of those between positions, which tell together how they turn
SLIPWISE_TUNING(kWheelLength, 1.0);               // [s] wheel speeds tell a step's response from its start on
constexpr double kLongestGap = 120.0;             // [s] between poses, after which the segment before it may still end
constexpr long kFramesApart = 1'000'000'000'000;  // numbers of frames before a break and after it are never the same
constexpr double kSpare = 10.0;                   // [s] that inputs are kept for longer than a segment may need
constexpr double kNever = std::numeric_limits<double>::infinity();

std::size_t index(Stream stream) { return static_cast<std::size_t>(stream); }

/// A standard deviation that can be one.
double allowed(double std) { return std >= 0.0 ? std : std::numeric_limits<double>::quiet_NaN(); }

SegmentRules between_positions(SegmentRules rules, double length) {
  rules.of_positions = length;
  return rules;
}

}  // namespace

SegmentStream::SegmentStream(const StreamSettings& settings)
    : settings_(settings),
      keep_(kLookBack + kSpare + settings.latency),
      newest_(-kNever),
      commands_(settings.unknown_after),
      wheels_(settings.unknown_after),
      range_{kNever, -kNever, kNever, -kNever},
      rates_(settings.sensor),
      held_(settings.unknown_after),
      now_(-kNever),
      learned_(settings.segment_length, between_positions(settings.rules, settings.segment_length),
               settings.whole_frames, settings.stride),
      slip_(kSlipLength, between_positions(settings.rules, kOfPositions), true),
      wheel_cutter_(kWheelLength, settings.rules, true),
      twists_(settings.rules, settings.sensor),
      courses_(settings.sensor) {
  double longest = settings.segment_length;
  for (const double horizon : settings.horizons) {
    targets_.emplace_back(horizon, settings.rules, false);
    longest = std::max(longest, horizon);
  }
  keep_ += 2.0 * longest;
  begin_others();
  if (settings.car) {
    car_.emplace(*settings.car, settings.sensor, settings.unknown_after);
  }
}

SegmentStream::SegmentStream(const SegmentStream&) = default;
SegmentStream::SegmentStream(SegmentStream&&) noexcept = default;
SegmentStream& SegmentStream::operator=(const SegmentStream&) = default;
SegmentStream& SegmentStream::operator=(SegmentStream&&) noexcept = default;
SegmentStream::~SegmentStream() = default;

std::optional<CarCurves> SegmentStream::car_curves() const {
  return car_ ? std::optional(car_->curves()) : std::nullopt;
}

void SegmentStream::start_run() {
  end_run();
  evidence_.start_run();
  newest_ = now_ = -kNever;
  stamps_.fill({});
  speeds_ = {};
  commands_.clear();
  wheels_.clear();
  tilts_.clear();
  forces_.clear();
  readings_.restart();
  turned_until_.reset();
  gate_.restart();
  timer_.restart();
  wheel_timer_.restart();
  std::ranges::for_each(others_, &PoseSource::restart);
  if (car_) {
    car_->start_run();
  }
}

void SegmentStream::end_run() {
  advance(kNever);
  process_accepted(gate_.finish(gate_inputs(now_)));
  finish_others();
  finish_cutters();
  rates_.restart();
  held_.restart();
  evidence_.end_run(wheels_);
}

/// Whether a measurement may be used; says why not.
bool SegmentStream::arrives(Stream stream, double t, std::span<const double> numbers, std::size_t kind) {
  evidence_.see_stamp(t);
  const bool too_late = std::isfinite(t) && later(newest_ - settings_.latency, t);
  if (const auto wrong = stamps_[index(stream) + kind].check(t, numbers)) {
    reject(stream, *wrong, t);
    return false;
  }
  if (too_late) {
    reject(stream, Reason::TooLate, t);
    return false;
  }
  newest_ = std::max(newest_, t);
  return true;
}

bool SegmentStream::take_input(Stream stream, const InputSample& sample) {
  const auto& [v, vy, omega] = sample.twist;
  if (!arrives(stream, sample.t, std::array{v, vy, omega})) {
    return false;
  }
  auto& gates = speeds_[index(stream)];
  const bool measured = stream == Stream::Wheels;
  const std::array plausible{gates[0].plausible(v, measured), gates[1].plausible(vy, measured),
                             gates[2].plausible(omega, measured)};
  if (!std::ranges::all_of(plausible, std::identity{})) {
    reject(stream, Reason::AbsurdSpeed, sample.t);
    return false;
  }
  InputBuffer& history = stream == Stream::Command ? commands_ : wheels_;
  history.push(sample);
  if (&history == &inputs()) {
    range_ = {std::min(range_[0], v), std::max(range_[1], v), std::min(range_[2], omega), std::max(range_[3], omega)};
    held_.push(sample);
  }
  return true;
}

bool SegmentStream::take(const CommandSample& command) {
  const InputSample& sample = command.sample;
  if (!car_) {
    return take_input(Stream::Command, sample);
  }
  CarStream& car = *car_;
  const bool taken = take_input(Stream::Command, {sample.t, car.expected(sample, settings_.latency)});
  if (taken) {
    car.push_command(sample, settings_.latency);
  }
  return taken;
}

bool SegmentStream::take(const WheelSample& wheels) {
  const bool taken = take_input(Stream::Wheels, wheels.sample);
  if (taken) {
    wheel_stamps_.push_back(wheels.sample.t);
  }
  return taken;
}

bool SegmentStream::take(const MeasuredPose& pose) {
  evidence_.see_stamp(pose.t);
  if (pose.fix == PoseFix::None) {
    reject(Stream::Pose, Reason::NoFix, pose.t);
    return false;
  }
  return pose.source == 0 ? take_first(pose) : take_other(pose);
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
    advance_others(pose.t);
    process_wheels(pose.t);
    process_pose(pose);
  }
  advance_others(until);
  process_wheels(until);
  evidence_.compare_gyro(until, commands_, wheels_);
  trim();
}

/// Wheel speeds end segments of their own, from which the actuator model is learned.
void SegmentStream::process_wheels(double until) {
  while (!wheel_stamps_.empty() && wheel_stamps_.front() <= until) {
    const double t = wheel_stamps_.front();
    wheel_stamps_.pop_front();
    wheels_ever_ = true;
    const auto timed = wheel_timer_.push({.t = t, .x = 0.0, .y = 0.0, .yaw = 0.0}, settings_.rules.late_factor);
    if (timed && settings_.from_commands) {
      emit_wheel_segments(wheel_cutter_.push(*timed, commands_));
    }
  }
}

void SegmentStream::process_pose(const MeasuredPose& raw) {
  now_ = raw.t;
  const MeasuredPose pose = complete(raw, accuracy_);
  if (settings_.heading_only) {
    process_accepted({.accepted = {pose}, .outliers = {}, .jumps = {}});
  } else {
    evidence_.see_measured(raw, commands_, wheels_);
    process_accepted(gate_.push(pose, gate_inputs(now_)));
  }
}

/// With its context: how the robot was tilted, and how exact its like were.
MeasuredPose SegmentStream::complete(const MeasuredPose& raw, PoseAccuracies& accuracies) const {
  MeasuredPose pose = raw;
  if (const auto tilt = tilts_.known_at(raw.t, settings_.unknown_after)) {
    pose.gx = gravity_of(*tilt).gx;
    pose.gy = gravity_of(*tilt).gy;
  }
  pose.std_ratio = accuracies[static_cast<std::size_t>(raw.fix)].ratio(raw.std);
  return pose;
}

/// Wheel speeds tell where the robot can have come, where there are some by then.
const InputBuffer& SegmentStream::gate_inputs(double t) const {
  return !wheels_.empty() && !later(wheels_.first(), t) ? wheels_ : commands_;
}

void SegmentStream::process_accepted(const GatedPoses& gated) {
  reject_gated(gated);
  if (!settings_.heading_only) {
    evidence_.see_gated(gated, commands_, wheels_);
  }
  for (const MeasuredPose& pose : gated.accepted) {
    auto timed = timer_.push(pose, settings_.rules.late_factor);
    if (!timed) {
      reject(Stream::Pose, Reason::LatePose, pose.t);
      continue;
    }
    readings_.gyro().see_inputs(pose.t, gate_inputs(pose.t), settings_.rules.still_speed);
    if (head(*timed, courses_)) {
      heading_ = timed->pose.yaw;
      rates_.push(timed->pose);
      if (pose.position) {
        readings_.gyro().see_course(timed->pose);
      }
      if (car_) {
        car_->push_pose(timed->pose);
      }
    }
    if (settings_.from_commands && wheels_ever_) {
      emit_slip(fitted(slip_.push(*timed, wheels_), settings_.sensor));
    } else if (settings_.from_commands && !pose.position &&
               !settings_.heading_only) {  // a course lags behind the heading by half its way
      emit_twists(twists_.push(*timed, commands_));
    }
    emit_learned(fitted(learned_.push(*timed, inputs()), settings_.sensor));
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      emit_targets(i, fitted(targets_[i].push(*timed, inputs()), settings_.sensor));
    }
  }
}

void SegmentStream::finish_cutters() {
  if (settings_.from_commands) {
    emit_wheel_segments(wheel_cutter_.finish(commands_));
    emit_twists(twists_.finish(commands_));
    if (wheels_ever_) {
      emit_slip(fitted(slip_.finish(wheels_), settings_.sensor));
    }
  }
  emit_learned(fitted(learned_.finish(inputs()), settings_.sensor));
  for (PoseSource& source : others_) {
    for (const SegmentCut& cut : fitted(source.cutter.finish(inputs()), source.settings.sensor)) {
      emit_other(source, cut, std::max(now_, cut.second.t));
    }
  }
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    emit_targets(i, fitted(targets_[i].finish(inputs()), settings_.sensor));
  }
}

InputHistory SegmentStream::commanded(const Segment& over, double back, double known,
                                      const std::vector<InputSample>& future) const {
  return car_ ? car_->inputs(path_start(over), over.end, known, future)
              : commands_.slice(path_start(over) - back, over.end, SliceKind::Commands, future);
}

/// Wheel speeds that drive a model are held until the next one, as it will be driven; behind commands they say what the
/// drive did.
InputHistory SegmentStream::wheels(double start, double end) const {
  return wheels_.slice(start, end, settings_.from_commands ? SliceKind::Measured : SliceKind::Wheels);
}

/// A segment to be learned, or over a `horizon` to be predicted from what was known one horizon before.
DrivenSegment SegmentStream::driven(const SegmentCut& cut, bool by_wheels, double known_at,
                                    std::optional<double> horizon) const {
  Segment segment{.start = cut.first.t,
                  .end = cut.second.t,
                  .measured = {{.sensor = {.place = settings_.sensor,
                                           .kind = PoseSensor{{cut.first.std_ratio, cut.second.std_ratio}}},
                                .z = cut.measured().vector()}},
                  .gx = cut.first.gx,
                  .gy = cut.first.gy,
                  .heading = cut.first.yaw};
  if (cut.fitted) {
    segment.measured.front().sensor.kind = cut.fitted->sensor;
    segment.measured.front().z = cut.fitted->z;
    segment.heading = cut.fitted->heading;
  }
  if (settings_.heading_only) {
    set_turn(segment);
  }
  readings_.measure(segment);
  stand_on_ground(segment, horizon.has_value());
  if (!by_wheels) {
    set_actuator_state(segment);
  }
  const double known = segment.start - (horizon ? settings_.age_of_known(*horizon) : 0.0);
  InputHistory driving =
      by_wheels ? wheels(path_start(segment) - kWheelsBack, segment.end) : commanded(segment, kLookBack, known);
  return {.inputs = std::move(driving), .segment = std::move(segment), .known_at = known_at};
}

/// What wheel speeds say of the actuator until the segment starts.
void SegmentStream::set_actuator_state(Segment& segment) const {
  segment.initial = wheels_.known_at(segment.start);
  if (segment.initial) {
    InputHistory until_start = wheels(path_start(segment) - kWheelsBack, segment.start);
    segment.known =
        MeasuredActuator{.twist = std::make_shared<const InputHistory>(std::move(until_start)), .until = segment.start};
  }
}

/// What tilts or pushes the robot: where it is `foreseen`, as far as is known at the start.
void SegmentStream::stand_on_ground(Segment& segment, bool foreseen) const {
  const double oldest = settings_.unknown_after;
  segment.ground =
      foreseen ? tilts_.from(segment.start, oldest) : tilts_.along(path_start(segment), segment.end, oldest);
  const auto force = foreseen ? forces_.at(segment.start) : forces_.mean(path_start(segment), segment.end);
  if (force) {
    segment.gx = force->x;
    segment.gy = force->y;
  }
}

/// Inputs are kept for segments that have begun, unless poses do not come for long.
void SegmentStream::trim() {
  double begun = std::max(now_, newest_ - settings_.latency);
  begun = std::min(begun, twists_.begins());
  for (const SegmentCutter* cutter : {&learned_, &slip_, &wheel_cutter_}) {
    begun = std::min(begun, cutter->begins());
  }
  for (const PoseSource& source : others_) {
    begun = std::min({begun, source.cutter.begins(), source.waiting.empty() ? begun : source.waiting.front().t});
  }
  for (const SegmentCutter& cutter : targets_) {
    begun = std::min(begun, cutter.begins());
  }
  const double oldest = std::max(begun, newest_ - settings_.latency - kLongestGap) - keep_;
  commands_.drop_before(oldest);
  wheels_.drop_before(oldest);
  tilts_.drop_before(oldest);
  forces_.drop_before(oldest);
  readings_.drop_before(oldest);
  if (car_) {
    car_->drop_before(oldest);
  }
}

std::vector<StreamItem> SegmentStream::take_items() { return std::exchange(items_, {}); }

std::vector<Rejected> SegmentStream::take_rejected() { return std::exchange(rejected_, {}); }

}  // namespace slipwise
