// SPDX-License-Identifier: Apache-2.0
// Bindings of cars commanded by throttle and steering: cpp/include/slipwise/actuator/car_curves.hpp.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "slipwise/actuator/car_curves.hpp"
#include "slipwise/identify/car_curve_filter.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {

void bind_car(nb::module_& m) {
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
             double cornering_drag, double understeer) {
            new (self) CarCurves{.speed = std::move(speed),
                                 .curvature = std::move(curvature),
                                 .lag = lag,
                                 .steering_lag = steering_lag,
                                 .cornering_drag = cornering_drag,
                                 .understeer = understeer};
          },
          "speed"_a, "curvature"_a, "lag"_a, "steering_lag"_a, "cornering_drag"_a, "understeer"_a)
      .def_ro("speed", &CarCurves::speed)
      .def_ro("curvature", &CarCurves::curvature)
      .def_ro("lag", &CarCurves::lag)
      .def_ro("steering_lag", &CarCurves::steering_lag)
      .def_ro("cornering_drag", &CarCurves::cornering_drag)
      .def_ro("understeer", &CarCurves::understeer)
      .def(
          "twists",
          [](const CarCurves& self, const InputHistory& commands, double start,
             std::optional<std::pair<double, double>> measured) {
            CarSpan span{.start = start, .end = settled_after(self, commands, start)};
            if (measured) {
              span.measured = KnownMotion{.t = measured->first, .speed = measured->second};
            }
            return car_twists(self, commands, span);
          },
          "commands"_a, "start"_a, "measured"_a.none(),
          "Mean twists from `start` [s] on, until the last of the commands has acted, under commands whose v is the "
          "throttle and whose omega the steering; `measured` is a time [s] and the speed [m/s] then.");
}

}  // namespace slipwise::bindings
