// SPDX-License-Identifier: Apache-2.0
// Segments with their inputs, the ground under them, what the drive did before them, and what sensors read over them.
#include "slipwise/online/measured_drive.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/learner_times.hpp"
#include "slipwise/online/position_fit.hpp"

namespace slipwise {
namespace {

constexpr double kUnknownTurn = 3.0;   // [rad] of a turn that a gyro did not see
constexpr double kLargestForce = 1e3;  // [m/s^2] that a caller may expect

/// What a car does by the curves that are known at the end.
InputBuffer by_curves(const CarStream& car, double start, double end) {
  const InputHistory twists = car.inputs(start, end, end);
  InputBuffer found(std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < twists.size(); ++i) {
    found.push({twists.time(i), twists.sample(i)});
  }
  return found;
}

/// The turn alone, by a gyro whose bias is known as far as it is when the segment is complete.
void set_turn(const MeasuredDrive& drive, Segment& segment) {
  const GyroTurn turn = drive.readings.gyro()
                            .turn(segment.start, segment.end)
                            .value_or(GyroTurn{rows_of(segment.measured)[2], kUnknownTurn});
  segment.measured = {measured_turn(turn)};
}

/// What wheel speeds say of the actuator until the segment starts.
void set_actuator_state(const MeasuredDrive& drive, Segment& segment) {
  segment.initial = drive.wheels.known_at(segment.start);
  if (segment.initial) {
    InputHistory until_start = drive.wheels_over(path_start(segment) - kWheelsBack, segment.start);
    segment.known =
        MeasuredActuator{.twist = std::make_shared<const InputHistory>(std::move(until_start)), .until = segment.start};
  }
}

/// What tilts or pushes the robot: where it is `foreseen`, as far as is known at the start.
void stand_on_ground(const MeasuredDrive& drive, Segment& segment, bool foreseen) {
  const double oldest = drive.settings.unknown_after;
  segment.ground =
      foreseen ? drive.tilts.from(segment.start, oldest) : drive.tilts.along(path_start(segment), segment.end, oldest);
  const auto force = foreseen ? drive.forces.at(segment.start) : drive.forces.mean(path_start(segment), segment.end);
  if (force) {
    segment.gx = force->x;
    segment.gy = force->y;
  }
}

std::vector<InputSample> repeated(const MeasuredDrive& drive, double start, double end,
                                  const std::vector<InputSample>& future) {
  const InputBuffer& given = drive.car && drive.settings.from_commands ? drive.car->given() : drive.inputs();
  std::vector<InputSample> all;
  std::optional<BodyTwist> held = given.known_at(start);
  double since = start;
  const auto repeat_until = [&](double t) {
    double next = since + drive.settings.unknown_after;
    while (held && next < t) {
      all.push_back({next, *held});
      next += drive.settings.unknown_after;
    }
  };
  for (const InputSample& sample : future) {
    repeat_until(std::min(sample.t, end));
    all.push_back(sample);
    held = sample.twist;
    since = std::max(sample.t, start);
  }
  repeat_until(end);
  return all;
}

}  // namespace

MeasuredDrive::MeasuredDrive(const StreamSettings& given)
    : settings(given), commands(given.unknown_after), wheels(given.unknown_after) {
  if (given.car) {
    car.emplace(*given.car, given.sensor, given.unknown_after);
  }
}

void MeasuredDrive::start_run() {
  commands.clear();
  wheels.clear();
  tilts.clear();
  forces.clear();
  readings.restart();
  if (car) {
    car->start_run();
  }
}

void MeasuredDrive::drop_before(double t) {
  commands.drop_before(t);
  wheels.drop_before(t);
  tilts.drop_before(t);
  forces.drop_before(t);
  readings.drop_before(t);
  if (car) {
    car->drop_before(t);
  }
}

const InputBuffer& MeasuredDrive::gate_inputs(double t) const {
  return !wheels.empty() && !later(wheels.first(), t) ? wheels : commands;
}

MeasuredPose MeasuredDrive::complete(const MeasuredPose& raw, PoseAccuracies& accuracies) const {
  MeasuredPose pose = raw;
  if (const auto tilt = tilts.known_at(raw.t, settings.unknown_after)) {
    pose.gx = gravity_of(*tilt).gx;
    pose.gy = gravity_of(*tilt).gy;
  }
  pose.std_ratio = accuracies[static_cast<std::size_t>(raw.fix)].ratio(raw.std);
  return pose;
}

std::vector<SegmentCut> MeasuredDrive::fitted(std::vector<SegmentCut> cuts, const Pose2& place) const {
  for (SegmentCut& cut : cuts) {
    if (cut.first.position && !cut.rejected) {
      const InputBuffer& best = gate_inputs(cut.first.t);
      const InputBuffer& way = best.unknown_since(cut.first.t, cut.second.t) ? inputs() : best;
      const bool curves = car && &way == &commands;
      cut.fitted = curves
                       ? fit_positions(cut.positions, cut.second.t, by_curves(*car, cut.first.t, cut.second.t), place)
                       : fit_positions(cut.positions, cut.second.t, way, place);
      cut.rejected = cut.fitted ? cut.rejected : std::optional(Reason::NoCourse);
    }
  }
  return cuts;
}

DrivenSegment MeasuredDrive::driven(const SegmentCut& cut, bool by_wheels, double known_at,
                                    std::optional<double> horizon) const {
  Segment segment{.start = cut.first.t,
                  .end = cut.second.t,
                  .measured = {{.sensor = {.place = settings.sensor,
                                           .kind = PoseSensor{{cut.first.std_ratio, cut.second.std_ratio}}},
                                .z = cut.measured().vector()}},
                  .gx = cut.first.gx,
                  .gy = cut.first.gy,
                  .heading = cut.first.yaw,
                  .ahead = by_wheels ? kWheelsAhead : 0.0};
  if (cut.fitted) {
    segment.measured.front().sensor.kind = cut.fitted->sensor;
    segment.measured.front().z = cut.fitted->z;
    segment.heading = cut.fitted->heading;
  }
  if (settings.heading_only) {
    set_turn(*this, segment);
  }
  readings.measure(segment);
  stand_on_ground(*this, segment, horizon.has_value());
  if (!by_wheels) {
    set_actuator_state(*this, segment);
  }
  const double known = segment.start - (horizon ? settings.age_of_known(*horizon) : 0.0);
  InputHistory driving = by_wheels ? wheels_over(path_start(segment) - kWheelsBack, segment.end + segment.ahead)
                                   : commanded(segment, kLookBack, known);
  return {.inputs = std::move(driving), .segment = std::move(segment), .known_at = known_at};
}

InputHistory MeasuredDrive::commanded(const Segment& over, double back, double known,
                                      const std::vector<InputSample>& future) const {
  return car ? car->inputs(path_start(over), over.end, known, future)
             : commands.slice(path_start(over) - back, over.end, SliceKind::Commands, future);
}

/// Wheel speeds that drive a model are held until the next one, as it will be driven; behind commands they say what the
/// drive did.
InputHistory MeasuredDrive::wheels_over(double start, double end) const {
  return wheels.slice(start, end, settings.from_commands ? SliceKind::Measured : SliceKind::Wheels);
}

DrivenSegment MeasuredDrive::stretch(Segment segment, double back) const {
  stand_on_ground(*this, segment, false);
  if (settings.from_commands) {
    set_actuator_state(*this, segment);
  }
  const double before = std::min(back, kLookBack), end = segment.end;
  InputHistory driving = settings.from_commands ? commanded(segment, before, segment.start)
                                                : wheels_over(segment.start - before, segment.end);
  return {.inputs = std::move(driving), .segment = std::move(segment), .known_at = end};
}

DrivenSegment MeasuredDrive::ahead(Segment segment, const std::vector<InputSample>& future) const {
  stand_on_ground(*this, segment, true);
  const bool by_wheels = !settings.from_commands;
  if (!by_wheels) {
    set_actuator_state(*this, segment);
  }
  const double now = segment.start;
  segment.ahead = by_wheels ? kWheelsAhead : 0.0;
  const double end = segment.end + segment.ahead;
  const std::vector<InputSample> all = repeated(*this, now, end, future);
  InputHistory driving = by_wheels ? wheels.slice(now - kWheelsBack, end, SliceKind::Wheels, all)
                                   : commanded(segment, kLookBack, now, all);
  return {.inputs = std::move(driving), .segment = std::move(segment), .known_at = now};
}

InputSpread MeasuredDrive::spread_ahead(double start, double end, const std::vector<InputSample>& future) const {
  return car && settings.from_commands ? car->spread(start, end, start, repeated(*this, start, end, future))
                                       : InputSpread{};
}

ForceBuffer MeasuredDrive::forces_ahead(double start, const std::vector<KnownForce>& future) const {
  ForceBuffer all = forces;
  double before = start;
  for (const KnownForce& force : future) {
    const double most = std::max(std::abs(force.x), std::abs(force.y));
    if (!(force.t > before) || !std::isfinite(force.t) || !(most <= kLargestForce)) {
      throw std::invalid_argument(
          "future forces must be finite, in m/s^2, and their stamps increase from the newest measurement on");
    }
    before = force.t;
    all.push(force);
  }
  if (!future.empty() && tilts.from(start, settings.unknown_after)) {
    throw std::invalid_argument("a known force acts on level ground alone, and attitudes were pushed");
  }
  return all;
}

}  // namespace slipwise
