// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/motion.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "checked_shapes.hpp"
#include "slipwise/motion/disturbance_model.hpp"
#include "slipwise/motion/motion_model.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {

void bind_motion(nb::module_& m) {
  nb::class_<ParameterInfo>(m, "ParameterInfo", "Name, unit and meaning of a parameter.")
      .def_ro("name", &ParameterInfo::name)
      .def_ro("unit", &ParameterInfo::unit)
      .def_ro("description", &ParameterInfo::description);
  nb::class_<MotionModel>(m, "MotionModel", "A slip basis behind an actuator model.")
      .def(
          "__init__",
          [](MotionModel* self, const Basis& basis, bool dynamics, bool clock_offset) {
            new (self) MotionModel(basis, {.dynamics = dynamics, .clock_offset = clock_offset});
          },
          "basis"_a, "dynamics"_a, "clock_offset"_a)
      .def_static(
          "with_response",
          [](const Basis& basis, bool clock_offset) {
            return MotionModel(basis, {.dynamics = true, .clock_offset = clock_offset, .response = true});
          },
          "basis"_a, "clock_offset"_a, "Lag, delay, gain and a slow mode per channel, as wheel speeds show them.")
      .def_static(
          "with_delays", [](const Basis& basis) { return MotionModel(basis, {.delays = true}); }, "basis"_a,
          "A delay per channel, and no actuator model behind it.")
      .def(
          "with_extrinsics",
          [](const MotionModel& model, bool sensor_extrinsics) {
            ActuatorParameters learned = model.learned();
            learned.sensor_extrinsics = sensor_extrinsics;
            return MotionModel(model.basis(), learned);
          },
          "sensor_extrinsics"_a,
          "The same with or without the pose of its pose sensor in base_link as three more parameters.")
      .def_prop_ro("basis", &MotionModel::basis)
      .def_prop_ro("dynamics", [](const MotionModel& model) { return model.learned().dynamics; })
      .def_prop_ro("delays", [](const MotionModel& model) { return model.learned().delays; })
      .def_prop_ro("clock_offset", [](const MotionModel& model) { return model.learned().clock_offset; })
      .def_prop_ro("response", [](const MotionModel& model) { return model.learned().response; })
      .def_prop_ro("sensor_extrinsics", [](const MotionModel& model) { return model.learned().sensor_extrinsics; })
      .def_prop_ro("size", &MotionModel::size)
      .def_prop_ro("slip_size", &MotionModel::slip_size)
      .def_prop_ro("actuator_size", &MotionModel::actuator_size)
      .def_prop_ro("parameters", &MotionModel::parameters)
      .def(
          "actuator",
          [](const MotionModel& model, const Eigen::VectorXd& parameters) {
            model.check(parameters);
            return model.actuator(parameters);
          },
          "parameters"_a);
  nb::class_<SlipDisturbance>(m, "SlipDisturbance",
                              "One guess of the slip disturbance: Gauss-Markov processes of one time constant.")
      .def(
          "__init__",
          [](SlipDisturbance* self, double linear, double angular, double time_constant) {
            new (self) SlipDisturbance{linear, angular, time_constant};
          },
          "linear"_a, "angular"_a, "time_constant"_a)
      .def_ro("linear", &SlipDisturbance::linear)
      .def_ro("angular", &SlipDisturbance::angular)
      .def_ro("time_constant", &SlipDisturbance::time_constant);
  nb::class_<DisturbanceModel>(m, "DisturbanceModel", "The slip disturbance: guesses and how likely each is.")
      .def(
          "__init__",
          [](DisturbanceModel* self, const std::vector<SlipDisturbance>& candidates, const Eigen::VectorXd& weights) {
            new (self) DisturbanceModel{candidates, weights};
            check_disturbance(*self);
          },
          "candidates"_a, "weights"_a)
      .def_ro("candidates", &DisturbanceModel::candidates)
      .def_ro("weights", &DisturbanceModel::weights);
  nb::class_<DisturbedTerms>(m, "DisturbedTerms", "The slip parameters that may disturbance.")
      .def_ro("places", &DisturbedTerms::places)
      .def("variances", &DisturbedTerms::variances, "disturbance"_a,
           "Under one guess, before anything recent is known.");
  m.def(
      "disturbed_terms",
      [](const MotionModel& model, const Eigen::VectorXd& prior_std) { return disturbed_terms(model, prior_std); },
      "model"_a, "prior_std"_a);
  m.def(
      "covariance_over",
      [](const MotionModel& model, const Eigen::MatrixXd& learned, const DisturbanceModel& law,
         const Eigen::VectorXd& prior_std, double seconds) {
        check_square(learned, model.size(), "the covariance of a model");
        return covariance_over(model, learned, law, prior_std, seconds);
      },
      "model"_a, "learned"_a, "law"_a, "prior_std"_a, "seconds"_a,
      "Covariance of the parameters' mean over some time, in which slip is disturbed about them.");
}

}  // namespace slipwise::bindings
