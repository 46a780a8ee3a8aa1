// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/actuator.
#include <nanobind/ndarray.h>

#include "bindings.hpp"
#include "slipwise/actuator/command_chain.hpp"
#include "slipwise/actuator/input_track.hpp"

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
      .def("at", &InputTrack::at, "t"_a, "The twist held at time t [s].");
  nb::class_<CommandChain>(m, "CommandChain", "Gain, delay, lags [s] per channel, and clock offset [s].")
      .def(
          "__init__",
          [](CommandChain* self, double lag_v, double lag_omega, double delay_v, double delay_omega,
             double clock_offset) {
            new (self) CommandChain{.lag_v = lag_v,
                                    .lag_omega = lag_omega,
                                    .delay_v = delay_v,
                                    .delay_omega = delay_omega,
                                    .clock_offset = clock_offset};
          },
          "lag_v"_a, "lag_omega"_a, "delay_v"_a, "delay_omega"_a, "clock_offset"_a)
      .def_ro("lag_v", &CommandChain::lag_v)
      .def_ro("lag_omega", &CommandChain::lag_omega)
      .def_ro("delay_v", &CommandChain::delay_v)
      .def_ro("delay_omega", &CommandChain::delay_omega)
      .def_ro("clock_offset", &CommandChain::clock_offset)
      .def_ro("gain_v", &CommandChain::gain_v)
      .def_ro("gain_omega", &CommandChain::gain_omega)
      .def_ro("slow_share_v", &CommandChain::slow_share_v)
      .def_ro("slow_share_omega", &CommandChain::slow_share_omega)
      .def_ro("slow_lag_v", &CommandChain::slow_lag_v)
      .def_ro("slow_lag_omega", &CommandChain::slow_lag_omega);
}

}  // namespace slipwise::bindings
