// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/dynamics, and dynamics that are written in Python.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>

#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "bindings.hpp"
#include "slipwise/dynamics/dynamics_filter.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

/// What a function of a user returned, of the shape that is needed.
Eigen::MatrixXd matrix_of(const nb::object& returned, const char* what, Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd matrix;
  if (!nb::try_cast(returned, matrix) || matrix.rows() != rows || matrix.cols() != columns) {
    throw std::invalid_argument(std::string(what) + " must be an array of " + std::to_string(rows) + " x " +
                                std::to_string(columns) + " numbers");
  }
  return matrix;
}

/// Dynamics whose functions are Python's: rates of several states at once, and their derivatives or None.
class PythonDynamics final : public DynamicsModel {
 public:
  PythonDynamics(nb::object rates, nb::object jacobians) : rates_(std::move(rates)), jacobians_(std::move(jacobians)) {
    if (PyCallable_Check(rates_.ptr()) == 0 || (!jacobians_.is_none() && PyCallable_Check(jacobians_.ptr()) == 0)) {
      throw std::invalid_argument("rates and jacobians must be functions");
    }
  }

  Eigen::VectorXd derivative(const Eigen::VectorXd& state, const Eigen::VectorXd& input,
                             const Eigen::VectorXd& parameters) const override {
    return derivatives(state, input, parameters);
  }

  Eigen::MatrixXd derivatives(const Eigen::MatrixXd& states, const Eigen::VectorXd& input,
                              const Eigen::MatrixXd& parameters) const override {
    return matrix_of(rates_(states, input, parameters), "the derivative of the state", states.rows(), states.cols());
  }

  DynamicsJacobians jacobians(const Eigen::VectorXd& state, const Eigen::VectorXd& input,
                              const Eigen::VectorXd& parameters) const override {
    if (jacobians_.is_none()) {
      return DynamicsModel::jacobians(state, input, parameters);
    }
    const auto both = nb::cast<nb::tuple>(jacobians_(state, input, parameters));
    return {.by_state = matrix_of(both[0], "the Jacobian by the state", state.size(), state.size()),
            .by_parameter = matrix_of(both[1], "the Jacobian by the parameters", state.size(), parameters.size())};
  }

 private:
  nb::object rates_;
  nb::object jacobians_;  ///< or None
};

void bind_settings(nb::module_& m) {
  nb::class_<DynamicsModel>(m, "DynamicsModel", "A user's own dynamics: x' = f(x, u, p).");
  nb::class_<PythonDynamics, DynamicsModel>(m, "PythonDynamics", "Dynamics whose functions are Python's.")
      .def(nb::init<nb::object, nb::object>(), "rates"_a, "jacobians"_a.none(),
           "Rates [states, N] of states [states, N], an input [inputs] and parameters [parameters, N]; Jacobians by "
           "state and by parameters of one state, or None for central differences.");
  nb::class_<DynamicsNoise>(m, "DynamicsNoise", "The measured part of a state, and its disturbance.")
      .def(
          "__init__",
          [](DynamicsNoise* self, std::vector<Eigen::Index> measured, std::vector<bool> angle,
             const Eigen::VectorXd& measurement_std, const Eigen::VectorXd& psd) {
            if (angle.size() != measured.size() || measurement_std.size() != std::ssize(measured)) {
              throw std::invalid_argument("each measured component needs a standard deviation, and whether it turns");
            }
            new (self) DynamicsNoise{std::move(measured), std::move(angle), measurement_std, psd};
          },
          "measured"_a, "angle"_a, "measurement_std"_a, "psd"_a);
  nb::class_<DynamicsUpdate>(m, "DynamicsUpdate", "One measurement's update.")
      .def_ro("innovation", &DynamicsUpdate::innovation, "[M] measured minus predicted.")
      .def_ro("nis", &DynamicsUpdate::nis, "Normalised innovation squared.")
      .def_ro("weight", &DynamicsUpdate::weight)
      .def_ro("status", &DynamicsUpdate::status);
  nb::class_<DynamicsPrediction>(m, "DynamicsPrediction", "Where the state will be.")
      .def_ro("t", &DynamicsPrediction::t, "[s]")
      .def_ro("state", &DynamicsPrediction::state, "[states]")
      .def_ro("covariance", &DynamicsPrediction::covariance, "[states, states]");
}

/// Inputs of a table, a row each.
HeldInputs held_inputs(const Eigen::VectorXd& t, const Eigen::MatrixXd& inputs) {
  if (t.size() != inputs.rows()) {
    throw std::invalid_argument("each input needs a stamp");
  }
  HeldInputs held;
  for (Eigen::Index i = 0; i < t.size(); ++i) {
    held.push(t[i], inputs.row(i));
  }
  return held;
}

}  // namespace

void bind_dynamics(nb::module_& m) {
  bind_settings(m);
  nb::class_<DynamicsFilter>(m, "DynamicsFilter", "State and parameters of a user's dynamics, learned together.")
      .def(
          "__init__",
          [](DynamicsFilter* self, std::shared_ptr<const DynamicsModel> model, const DynamicsNoise& noise,
             double longest_step, double t, const Estimate& start) {
            new (self) DynamicsFilter(std::move(model), {.noise = noise, .longest_step = longest_step}, t, start);
          },
          "model"_a, "noise"_a, "longest_step"_a, "t"_a, "start"_a)
      .def("push_input", &DynamicsFilter::push_input, "t"_a, "input"_a, "Held from `t` [s] on.")
      .def("push_measurement", &DynamicsFilter::push_measurement, "t"_a, "measured"_a)
      .def(
          "predict",
          [](const DynamicsFilter& self, const std::vector<double>& times, const Eigen::VectorXd& t,
             const Eigen::MatrixXd& inputs) { return self.predict(times, held_inputs(t, inputs)); },
          "times"_a, "t"_a, "inputs"_a,
          "Where the state will be at times [s] under inputs [N, inputs] with stamps [N]; what is held now where there "
          "are none.")
      .def_prop_ro("time", &DynamicsFilter::time, "Of the last measurement [s].")
      .def_prop_ro("state", &DynamicsFilter::state)
      .def_prop_ro("parameters", &DynamicsFilter::parameters)
      .def_prop_ro("reported_parameters", &DynamicsFilter::reported_parameters);
}

}  // namespace slipwise::bindings
