// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/actuator: its parameters, the curves of cars, and its limits.
#include <nanobind/eigen/dense.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "slipwise/actuator/actuator_model.hpp"
#include "slipwise/actuator/actuator_output.hpp"
#include "slipwise/actuator/car_curves.hpp"
#include "slipwise/actuator/command_limiter.hpp"
#include "slipwise/actuator/command_limits.hpp"
#include "slipwise/actuator/input_history.hpp"
#include "slipwise/actuator/kinematics.hpp"
#include "slipwise/actuator/limit_kinds.hpp"
#include "slipwise/actuator/measured_start.hpp"
#include "slipwise/identify/car_curve_filter.hpp"
#include "slipwise/identify/limit_search.hpp"
#include "slipwise/segment/input_spread.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {

namespace {

void bind_limit_kinds(nb::module_& m) {
  nb::class_<AxisLimits> limits(m, "AxisLimits", "Dead-band, saturation and slew rates of one axis of the actuator.");
  limits.def(
      "__init__",
      [](AxisLimits* self, double dead_band, double saturation, double slew_rate_up, double slew_rate_down,
         double slew_rate_lag) {
        new (self) AxisLimits{dead_band, saturation, slew_rate_up, slew_rate_down, slew_rate_lag};
      },
      "dead_band"_a = AxisLimits{}.dead_band, "saturation"_a = AxisLimits{}.saturation,
      "slew_rate_up"_a = AxisLimits{}.slew_rate_up, "slew_rate_down"_a = AxisLimits{}.slew_rate_down,
      "slew_rate_lag"_a = AxisLimits{}.slew_rate_lag);
  nb::enum_<LimitKind> kinds(m, "LimitKind");
  for (std::size_t kind = 0; kind < kLimits.size(); ++kind) {
    kinds.value(kLimits.at(kind).name, static_cast<LimitKind>(kind));
    limits.def_ro(kLimits.at(kind).name, kLimits.at(kind).value);
  }
  nb::class_<LimitRow>(m, "LimitRow", "A kind of limit that an axis of the drive may have.")
      .def_ro("name", &LimitRow::name)
      .def_prop_ro(
          "absent", [](const LimitRow& row) { return AxisLimits{}.*row.value; }, "What limits nothing.")
      .def_ro("per_second", &LimitRow::per_second,
              "Its unit is that of the axis over seconds to this power; of -1, seconds alone.")
      .def_ro("words", &LimitRow::words, "Before the number in a sentence.");
  m.def("limit_rows", [] { return std::vector(kLimits.begin(), kLimits.end()); }, "In the order of `LimitKind`.");
}

}  // namespace

void bind_actuator(nb::module_& m) {
  using Array = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
  nb::class_<InputHistory>(m, "InputHistory", "Sample-and-hold inputs over time.")
      .def(
          "__init__",
          [](InputHistory* self, Array t, Array v, Array vy, Array omega) {
            const auto span = [](const Array& a) { return std::span<const double>(a.data(), a.size()); };
            new (self) InputHistory(span(t), span(v), span(vy), span(omega));
          },
          "t"_a, "v"_a, "vy"_a, "omega"_a)
      .def("__len__", &InputHistory::size)
      .def("at", &InputHistory::at, "t"_a, "The twist held at time t [s].")
      .def(
          "rows",
          [](const InputHistory& history) {
            Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> rows(history.size(), 4);
            for (std::size_t i = 0; i < history.size(); ++i) {
              const BodyTwist twist = history.sample(i);
              rows.row(static_cast<Eigen::Index>(i)) << history.time(i), twist.v, twist.vy, twist.omega;
            }
            return rows;
          },
          "All samples, [N, 4]: t [s], v [m/s], vy [m/s], omega [rad/s].");
  nb::class_<ActuatorModel>(m, "ActuatorModel", "Gain, delay, lags [s] per channel, and clock offset [s].")
      .def(
          "__init__",
          [](ActuatorModel* self, double time_constant_v, double time_constant_omega, double delay_v,
             double delay_omega, double clock_offset) {
            new (self) ActuatorModel{.time_constant_v = time_constant_v,
                                     .time_constant_omega = time_constant_omega,
                                     .delay_v = delay_v,
                                     .delay_omega = delay_omega,
                                     .clock_offset = clock_offset};
          },
          "time_constant_v"_a, "time_constant_omega"_a, "delay_v"_a, "delay_omega"_a, "clock_offset"_a)
      .def_ro("time_constant_v", &ActuatorModel::time_constant_v)
      .def_ro("time_constant_omega", &ActuatorModel::time_constant_omega)
      .def_ro("delay_v", &ActuatorModel::delay_v)
      .def_ro("delay_omega", &ActuatorModel::delay_omega)
      .def_ro("clock_offset", &ActuatorModel::clock_offset)
      .def_ro("gain_v", &ActuatorModel::gain_v)
      .def_ro("gain_omega", &ActuatorModel::gain_omega)
      .def_ro("slow_fraction_v", &ActuatorModel::slow_fraction_v)
      .def_ro("slow_fraction_omega", &ActuatorModel::slow_fraction_omega)
      .def_ro("slow_time_constant_v", &ActuatorModel::slow_time_constant_v)
      .def_ro("slow_time_constant_omega", &ActuatorModel::slow_time_constant_omega);
  bind_limit_kinds(m);
  nb::class_<CommandLimits>(m, "CommandLimits",
                            "Limits of the commands, and then of the sides `wheel_separation` [m] apart.")
      .def(
          "__init__",
          [](CommandLimits* self, const AxisLimits& speed, const AxisLimits& yaw_rate, const AxisLimits& side,
             double wheel_separation, double gain_v, double gain_omega) {
            new (self) CommandLimits{speed, yaw_rate, side, wheel_separation, gain_v, gain_omega};
          },
          "speed"_a, "yaw_rate"_a, "side"_a, "wheel_separation"_a, "gain_v"_a, "gain_omega"_a)
      .def_ro("speed", &CommandLimits::speed)
      .def_ro("yaw_rate", &CommandLimits::yaw_rate)
      .def_ro("side", &CommandLimits::side)
      .def_ro("wheel_separation", &CommandLimits::wheel_separation)
      .def_ro("gain_v", &CommandLimits::gain_v)
      .def_ro("gain_omega", &CommandLimits::gain_omega)
      .def(
          "settled", [](const CommandLimits& self, const BodyTwist& command) { return settled(self, command); },
          "command"_a, "The part of a command that remains if it is held for long.");
  m.def("limited_inputs", nb::overload_cast<const InputHistory&, const CommandLimits&, double>(&limited_inputs),
        "commands"_a, "limits"_a, "longest_piece"_a,
        "The held commands after dead-band, saturation and rate limits; ramps become short held pieces [s].");
  m.def(
      "limited_inputs_from",
      [](const InputHistory& commands, const CommandLimits& limits, const ActuatorModel& actuator, double time,
         const BodyTwist& measured) {
        return limited_inputs(commands, limits, measured_start(actuator, time, measured), kRampPiece);
      },
      "commands"_a, "limits"_a, "actuator"_a, "time"_a, "measured"_a,
      "The same where the drive did `measured` at `time` [s], in the stamps of the commands.");
  m.attr("RAMP_PIECE") = kRampPiece;
  m.attr("STANDING_SPEED") = kStandingSpeed;
  m.attr("SHOWS_CURVATURE") = kShowsCurvature;
  m.attr("SHARPEST_TANGENT") = kSharpestTangent;
  m.def(
      "actuator_output",
      [](const InputHistory& inputs, const ActuatorModel& actuator, Array times, const BodyTwist& initial) {
        const ActuatorOutput output =
            actuator_output(inputs, actuator, std::span<const double>(times.data(), times.size()), initial);
        Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor> rows(times.size(), 2);
        for (std::size_t i = 0; i < times.size(); ++i) {
          rows.row(static_cast<Eigen::Index>(i)) << output.v[i], output.omega[i];
        }
        return rows;
      },
      "inputs"_a, "actuator"_a, "times"_a, "initial"_a, "The drive's speed and yaw rate at the times, [N, 2].");
}

namespace {

/// From `start` [s] on until the last of the commands has acted.
CarSpan whole_span(const CarCurves& car, const InputHistory& commands, double start,
                   const std::optional<std::pair<double, double>>& measured) {
  CarSpan span{.start = start, .end = settled_after(car, commands, start)};
  if (measured) {
    span.measured = KnownMotion{.t = measured->first, .speed = measured->second};
  }
  return span;
}

CarCurves with_spread(CarCurves car, const Eigen::MatrixXd& covariance, const Eigen::VectorXd& prior_std) {
  const Eigen::Index size = car_numbers(car).size();
  if (covariance.rows() != size || covariance.cols() != size || prior_std.size() != size || !covariance.allFinite()) {
    throw std::invalid_argument("the covariance and the prior of a car need a row for each of its " +
                                std::to_string(size) + " numbers");
  }
  car.spread = std::make_shared<const CarSpread>(CarSpread{.covariance = covariance, .prior_std = prior_std});
  return car;
}

}  // namespace

void bind_car(nb::module_& m) {
  nb::class_<InputSpread>(m, "InputSpread", "What inputs may be, along each direction of their uncertainty.")
      .def_ro("deviated", &InputSpread::deviated)
      .def_ro("step", &InputSpread::step, "Standard deviations by which each is off.");
  nb::class_<CarPrior>(m, "CarPrior", "What is taken of a car before it drives: straight curves.")
      .def(
          "__init__",
          [](CarPrior* self, double top_speed, double curvature, std::optional<CarCurves> held) {
            new (self) CarPrior{.top_speed = top_speed, .curvature = curvature, .held = std::move(held)};
          },
          "top_speed"_a, "curvature"_a, "held"_a.none(),
          "Held curves are taken by predictions in place of those that are learned meanwhile.")
      .def_ro("top_speed", &CarPrior::top_speed)
      .def_ro("curvature", &CarPrior::curvature)
      .def_ro("held", &CarPrior::held);
  nb::class_<KnotCurve>(m, "KnotCurve", "A function that is straight between its knots.")
      .def(
          "__init__",
          [](KnotCurve* self, std::vector<double> at, std::vector<double> value, std::vector<double> std) {
            new (self) KnotCurve{.at = std::move(at), .value = std::move(value), .std = std::move(std)};
          },
          "at"_a, "value"_a, "std"_a)
      .def_ro("at", &KnotCurve::at)
      .def_ro("value", &KnotCurve::value)
      .def_ro("std", &KnotCurve::std);
  nb::class_<CarCurves>(m, "CarCurves", "What throttle and steering of a car do.")
      .def(
          "__init__",
          [](CarCurves* self, KnotCurve speed, KnotCurve curvature, double lag, double steering_lag,
             double cornering_drag, double understeer, double delay) {
            new (self) CarCurves{.speed = std::move(speed),
                                 .curvature = std::move(curvature),
                                 .lag = lag,
                                 .steering_lag = steering_lag,
                                 .cornering_drag = cornering_drag,
                                 .understeer = understeer,
                                 .delay = delay};
          },
          "speed"_a, "curvature"_a, "lag"_a, "steering_lag"_a, "cornering_drag"_a, "understeer"_a, "delay"_a = 0.0)
      .def_ro("speed", &CarCurves::speed)
      .def_ro("curvature", &CarCurves::curvature)
      .def_ro("lag", &CarCurves::lag)
      .def_ro("steering_lag", &CarCurves::steering_lag)
      .def_ro("cornering_drag", &CarCurves::cornering_drag)
      .def_ro("understeer", &CarCurves::understeer)
      .def_ro("delay", &CarCurves::delay)
      .def(
          "twists",
          [](const CarCurves& self, const InputHistory& commands, double start,
             std::optional<std::pair<double, double>> measured) {
            return car_twists(self, commands, whole_span(self, commands, start, measured));
          },
          "commands"_a, "start"_a, "measured"_a.none(),
          "Mean twists from `start` [s] on, until the last of the commands has acted, under commands whose v is the "
          "throttle and whose omega the steering; `measured` is a time [s] and the speed [m/s] then.")
      .def(
          "spread",
          [](const CarCurves& self, const InputHistory& commands, double start,
             std::optional<std::pair<double, double>> measured) {
            const CarDeviations deviations = car_deviations(self, commands);
            InputSpread found{.deviated = {}, .step = deviations.step};
            for (const CarCurves& car : deviations.cars) {
              found.deviated.push_back(car_twists(car, commands, whole_span(self, commands, start, measured)));
            }
            return found;
          },
          "commands"_a, "start"_a, "measured"_a.none(),
          "How `twists` may be else, along each direction in which the car is uncertain.")
      .def(
          "deviations",
          [](const CarCurves& self, const InputHistory& commands) {
            CarDeviations found = car_deviations(self, commands);
            return std::pair(std::move(found.cars), found.step);
          },
          "commands"_a,
          "Cars that differ from this one along the directions of its uncertainty that matter under the commands, and "
          "by how many standard deviations.")
      .def("with_spread", &with_spread, "covariance"_a, "prior_std"_a,
           "The same car, whose `numbers` are uncertain so much.")
      .def_prop_ro("numbers", &car_numbers,
                   "Speed and curvature at the knots, lag, steering lag, drag of cornering, understeer, delay.")
      .def_prop_ro(
          "covariance",
          [](const CarCurves& self) { return self.spread ? std::optional(self.spread->covariance) : std::nullopt; },
          "Of the `numbers`; None where they are taken as exact.")
      .def_prop_ro(
          "prior_std",
          [](const CarCurves& self) { return self.spread ? std::optional(self.spread->prior_std) : std::nullopt; },
          "Of the `numbers`, before the car drove.");
  m.def(
      "input_covariances",
      [](const MotionModel& model, const Eigen::VectorXd& parameters, const InputHistory& inputs,
         const InputSpread& spread, const Segment& segment, const std::vector<double>& times) {
        return input_covariances(model, parameters, {.inputs = inputs, .segment = segment}, spread, times);
      },
      "model"_a, "parameters"_a, "inputs"_a, "spread"_a, "segment"_a, "times"_a,
      "Covariances [3, 3] of the poses at `times` [s] of a segment, of its inputs' uncertainty alone.");
}

void bind_limits(nb::module_& m) {
  using Rows = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
  nb::class_<WheelRecord>(m, "WheelRecord", "Commands without a gap, and wheel twists beside them.")
      .def(
          "__init__",
          [](WheelRecord* self, const InputHistory& commands, Rows wheels) {
            WheelRecord record{.commands = commands, .t = {}, .wheels = {}};
            for (std::size_t i = 0; i < wheels.shape(0); ++i) {
              const double* row = wheels.data() + 3 * i;
              record.t.push_back(row[0]);
              record.wheels.push_back({row[1], 0.0, row[2]});
            }
            if (record.t.empty()) {
              throw std::invalid_argument("a record has no wheel twists; leave it out");
            }
            new (self) WheelRecord(std::move(record));
          },
          "commands"_a, "wheels"_a, "`wheels` are rows of t [s], v [m/s], omega [rad/s].");
  nb::enum_<LimitedAxis>(m, "LimitedAxis", "The commanded speed, the commanded yaw rate, or both sides.")
      .value("Speed", LimitedAxis::Speed)
      .value("YawRate", LimitedAxis::YawRate)
      .value("Side", LimitedAxis::Side);
  nb::class_<FoundLimit>(m, "FoundLimit", "A limit that the data show, with its standard deviation.")
      .def_ro("axis", &FoundLimit::axis)
      .def_ro("kind", &FoundLimit::kind)
      .def_ro("value", &FoundLimit::value)
      .def_ro("std", &FoundLimit::std)
      .def_ro("gain", &FoundLimit::gain);
  nb::class_<AxisReach>(m, "AxisReach", "What the commands reached in an axis.")
      .def_ro("slowest", &AxisReach::slowest)
      .def_ro("fastest", &AxisReach::fastest)
      .def_ro("step", &AxisReach::step);
  nb::class_<LimitSearch>(m, "LimitSearch", "What a search for limits found.")
      .def_prop_ro("limits", [](const LimitSearch& search) { return search.drive.limits; })
      .def_prop_ro("actuator", [](const LimitSearch& search) { return search.drive.actuator; })
      .def_ro("found", &LimitSearch::found)
      .def_ro("wheel_separation_std", &LimitSearch::wheel_separation_std)
      .def_ro("reach", &LimitSearch::reach);
  m.def(
      "find_limits",
      [](const std::vector<WheelRecord>& records, const PriorSettings& prior, double wheel_separation,
         double least_gain, const LimitSearch* before) {
        const auto start = before == nullptr ? std::nullopt : std::optional<LimitedActuator>(before->drive);
        return find_limits(records, prior, wheel_separation, {.least_gain = least_gain}, start);
      },
      "records"_a, "prior"_a, "wheel_separation"_a, "least_gain"_a, "before"_a.none(),
      "The limits that wheel speeds show; the search goes on from those found `before`.");
  m.attr("LEAST_LIMIT_GAIN") = LimitSearchSettings{}.least_gain;
}

}  // namespace slipwise::bindings
