// SPDX-License-Identifier: Apache-2.0
// Bindings of cars commanded by throttle and steering: cpp/include/slipwise/actuator/car_curves.hpp.
#include <nanobind/eigen/dense.h>
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
#include "slipwise/actuator/car_curves.hpp"
#include "slipwise/identify/car_curve_filter.hpp"
#include "slipwise/segment/input_spread.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {

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
                   "Speed and curvature at the knots, lag, steering lag, drag of cornering, understeer.")
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

}  // namespace slipwise::bindings
