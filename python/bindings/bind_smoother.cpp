// SPDX-License-Identifier: Apache-2.0
// Bindings of the smoother, and of the actuator that is learned from wheel speeds.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "checked_shapes.hpp"
#include "slipwise/filter/rts_smoother.hpp"
#include "slipwise/identify/actuator_filter.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {

void bind_smoother(nb::module_& m) {
  nb::enum_<Drift>(m, "Drift").value("RandomWalk", Drift::RandomWalk).value("MeanReverting", Drift::MeanReverting);
  nb::class_<DriftSettings>(m, "DriftSettings", "How parameters may change with the distance driven.")
      .def(nb::init<>())
      .def_rw("drift", &DriftSettings::drift)
      .def_rw("length", &DriftSettings::length);
  m.def(
      "rts_smooth",
      [](const MotionModel& model, const Estimate& prior, const std::vector<const InputHistory*>& inputs,
         const std::vector<Segment>& segments, const std::vector<Eigen::Matrix3d>& noise, const DriftSettings& drift,
         const IekfSettings& iekf) {
        check_inputs(inputs, segments.size(), noise.size());
        std::vector<BatchDatum> data;
        for (std::size_t i = 0; i < segments.size(); ++i) {
          data.push_back({*inputs[i], segments[i], noise[i]});
        }
        return rts_smooth(model, prior, data, drift, iekf);
      },
      "model"_a, "prior"_a, "inputs"_a, "segments"_a, "noise"_a, "drift"_a, "iekf"_a,
      "The parameters during each segment, given all segments, as a list of Estimate.");
}

void bind_actuator_filter(nb::module_& m) {
  nb::class_<ActuatorUpdate>(m, "ActuatorUpdate", "How a window of wheel speeds was predicted.")
      .def_ro("nis", &ActuatorUpdate::nis);
  nb::class_<ActuatorFilter>(m, "ActuatorFilter", "The actuator, learned from commands and wheel speeds.")
      .def(nb::init<const CausalFilterSettings&>(), "settings"_a)
      .def("learn", &ActuatorFilter::learn, "inputs"_a, "wheels"_a, "start"_a, "end"_a,
           "Learns the wheel speeds from start to end [s], in input stamps.")
      .def("estimate", &ActuatorFilter::estimate)
      .def_prop_ro("model", &ActuatorFilter::model)
      .def_prop_ro("prior_std", &ActuatorFilter::prior_std);
}

}  // namespace slipwise::bindings
