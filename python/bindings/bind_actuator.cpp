// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/actuator.
#include <nanobind/eigen/dense.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "slipwise/actuator/actuator_model.hpp"
#include "slipwise/actuator/actuator_output.hpp"
#include "slipwise/actuator/command_limiter.hpp"
#include "slipwise/actuator/command_limits.hpp"
#include "slipwise/actuator/input_history.hpp"
#include "slipwise/actuator/measured_start.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {

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
  nb::class_<AxisLimits>(m, "AxisLimits", "Dead-band, saturation and slew rates of one axis of the actuator.")
      .def(
          "__init__",
          [](AxisLimits* self, double dead_band, double saturation, double slew_rate_up, double slew_rate_down) {
            new (self) AxisLimits{dead_band, saturation, slew_rate_up, slew_rate_down};
          },
          "dead_band"_a = AxisLimits{}.dead_band, "saturation"_a = AxisLimits{}.saturation,
          "slew_rate_up"_a = AxisLimits{}.slew_rate_up, "slew_rate_down"_a = AxisLimits{}.slew_rate_down)
      .def_ro("dead_band", &AxisLimits::dead_band)
      .def_ro("saturation", &AxisLimits::saturation)
      .def_ro("slew_rate_up", &AxisLimits::slew_rate_up)
      .def_ro("slew_rate_down", &AxisLimits::slew_rate_down);
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

}  // namespace slipwise::bindings
