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
#include "slipwise/actuator/input_track.hpp"
#include "slipwise/actuator/measured_start.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {

void bind_actuator(nb::module_& m) {
  using Array = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
  nb::class_<InputTrack>(m, "InputTrack", "Sample-and-hold inputs over time.")
      .def(
          "__init__",
          [](InputTrack* self, Array t, Array v, Array vy, Array omega) {
            const auto span = [](const Array& a) { return std::span<const double>(a.data(), a.size()); };
            new (self) InputTrack(span(t), span(v), span(vy), span(omega));
          },
          "t"_a, "v"_a, "vy"_a, "omega"_a)
      .def("__len__", &InputTrack::size)
      .def("at", &InputTrack::at, "t"_a, "The twist held at time t [s].")
      .def(
          "rows",
          [](const InputTrack& track) {
            Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> rows(track.size(), 4);
            for (std::size_t i = 0; i < track.size(); ++i) {
              const BodyTwist twist = track.sample(i);
              rows.row(static_cast<Eigen::Index>(i)) << track.time(i), twist.v, twist.vy, twist.omega;
            }
            return rows;
          },
          "All samples, [N, 4]: t [s], v [m/s], vy [m/s], omega [rad/s].");
  nb::class_<ActuatorModel>(m, "ActuatorModel", "Gain, delay, lags [s] per channel, and clock offset [s].")
      .def(
          "__init__",
          [](ActuatorModel* self, double lag_v, double lag_omega, double delay_v, double delay_omega,
             double clock_offset) {
            new (self) ActuatorModel{.lag_v = lag_v,
                                     .lag_omega = lag_omega,
                                     .delay_v = delay_v,
                                     .delay_omega = delay_omega,
                                     .clock_offset = clock_offset};
          },
          "lag_v"_a, "lag_omega"_a, "delay_v"_a, "delay_omega"_a, "clock_offset"_a)
      .def_ro("lag_v", &ActuatorModel::lag_v)
      .def_ro("lag_omega", &ActuatorModel::lag_omega)
      .def_ro("delay_v", &ActuatorModel::delay_v)
      .def_ro("delay_omega", &ActuatorModel::delay_omega)
      .def_ro("clock_offset", &ActuatorModel::clock_offset)
      .def_ro("gain_v", &ActuatorModel::gain_v)
      .def_ro("gain_omega", &ActuatorModel::gain_omega)
      .def_ro("slow_share_v", &ActuatorModel::slow_share_v)
      .def_ro("slow_share_omega", &ActuatorModel::slow_share_omega)
      .def_ro("slow_lag_v", &ActuatorModel::slow_lag_v)
      .def_ro("slow_lag_omega", &ActuatorModel::slow_lag_omega);
  nb::class_<AxisLimits>(m, "AxisLimits", "Dead-band, top, acceleration and braking of one axis of the drive.")
      .def(
          "__init__",
          [](AxisLimits* self, double dead_band, double top, double acceleration, double braking) {
            new (self) AxisLimits{dead_band, top, acceleration, braking};
          },
          "dead_band"_a = AxisLimits{}.dead_band, "top"_a = AxisLimits{}.top,
          "acceleration"_a = AxisLimits{}.acceleration, "braking"_a = AxisLimits{}.braking)
      .def_ro("dead_band", &AxisLimits::dead_band)
      .def_ro("top", &AxisLimits::top)
      .def_ro("acceleration", &AxisLimits::acceleration)
      .def_ro("braking", &AxisLimits::braking);
  nb::class_<CommandLimits>(m, "CommandLimits", "Limits of the commands, and then of the sides `track` [m] apart.")
      .def(
          "__init__",
          [](CommandLimits* self, const AxisLimits& speed, const AxisLimits& yaw_rate, const AxisLimits& side,
             double track, double gain_v,
             double gain_omega) { new (self) CommandLimits{speed, yaw_rate, side, track, gain_v, gain_omega}; },
          "speed"_a, "yaw_rate"_a, "side"_a, "track"_a, "gain_v"_a, "gain_omega"_a)
      .def_ro("speed", &CommandLimits::speed)
      .def_ro("yaw_rate", &CommandLimits::yaw_rate)
      .def_ro("side", &CommandLimits::side)
      .def_ro("track", &CommandLimits::track)
      .def_ro("gain_v", &CommandLimits::gain_v)
      .def_ro("gain_omega", &CommandLimits::gain_omega)
      .def(
          "settled", [](const CommandLimits& self, const BodyTwist& command) { return settled(self, command); },
          "command"_a, "What is left of a command that is held for long.");
  m.def("limited_track", nb::overload_cast<const InputTrack&, const CommandLimits&, double>(&limited_track),
        "commands"_a, "limits"_a, "longest_piece"_a,
        "The held commands after dead-band, saturation and rate limits; ramps become short held pieces [s].");
  m.def(
      "limited_track_from",
      [](const InputTrack& commands, const CommandLimits& limits, const ActuatorModel& actuator, double time,
         const BodyTwist& measured) {
        return limited_track(commands, limits, measured_start(actuator, time, measured), kRampPiece);
      },
      "commands"_a, "limits"_a, "actuator"_a, "time"_a, "measured"_a,
      "The same where the drive did `measured` at `time` [s], in the stamps of the commands.");
  m.attr("RAMP_PIECE") = kRampPiece;
  m.def(
      "actuator_output",
      [](const InputTrack& inputs, const ActuatorModel& actuator, Array times, const BodyTwist& initial) {
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
