// SPDX-License-Identifier: Apache-2.0
// Bindings of the estimators behind one interface.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "checked_shapes.hpp"
#include "slipwise/thesis/estimator.hpp"
#include "slipwise/thesis/following_estimator.hpp"
#include "thesis_bindings.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

void bind_estimator_settings(nb::module_& m) {
  nb::enum_<SegmentJacobian>(m, "SegmentJacobian")
      .value("Exact", SegmentJacobian::Exact)
      .value("Thesis", SegmentJacobian::Thesis);
  nb::class_<GradientDescentSettings>(m, "GradientDescentSettings")
      .def(nb::init<>())
      .def_rw("learning_rate", &GradientDescentSettings::learning_rate)
      .def_rw("damping", &GradientDescentSettings::damping)
      .def_rw("jacobian", &GradientDescentSettings::jacobian);
  nb::class_<EkfThesisSettings>(m, "EkfThesisSettings")
      .def(nb::init<>())
      .def_rw("process_std", &EkfThesisSettings::process_std)
      .def_rw("jacobian", &EkfThesisSettings::jacobian);
  nb::class_<DelayedStateSettings>(m, "DelayedStateSettings")
      .def(nb::init<>())
      .def_rw("iterations", &DelayedStateSettings::iterations);
  nb::class_<EstimatorSettings>(m, "EstimatorSettings", "Noise, and what each estimator reads under its own name.")
      .def(nb::init<>())
      .def_rw("noise", &EstimatorSettings::noise)
      .def_rw("iekf", &EstimatorSettings::iekf)
      .def_rw("gradient_descent", &EstimatorSettings::gradient_descent)
      .def_rw("ekf_thesis", &EstimatorSettings::ekf_thesis)
      .def_rw("delayed_state", &EstimatorSettings::delayed_state);
}

}  // namespace

void bind_estimators(nb::module_& m) {
  bind_estimator_settings(m);
  nb::class_<Estimator>(m, "Estimator", "An estimator of a model's parameters.")
      .def("learn", &Estimator::learn, "inputs"_a, "segment"_a)
      .def("estimate", &Estimator::estimate)
      .def("running", &Estimator::running, "What learning goes on from: the estimate, unless that fits all segments.")
      .def_prop_ro("model", &Estimator::model);
  m.def("estimator_names", &estimator_names, "Names that make_estimator knows.");
  m.def("learns_overlapping_segments", &learns_overlapping_segments, "name"_a,
        "True for those that the thesis feeds with overlapping segments at 20 Hz.");
  m.def("make_estimator", &make_estimator, "name"_a, "model"_a, "prior"_a, "settings"_a, "An estimator by its name.");
  nb::class_<FollowingEstimator>(m, "FollowingEstimator",
                                 "An estimator whose prior follows the speeds and whose noise follows the residuals.")
      .def(
          "__init__",
          [](FollowingEstimator* self, const std::string& name, const MotionModel& model,
             const CausalFilterSettings& filter,
             const EstimatorSettings& settings) { new (self) FollowingEstimator(name, model, filter, settings); },
          "name"_a, "model"_a, "filter"_a, "settings"_a)
      .def("learn", &FollowingEstimator::learn, "inputs"_a, "segment"_a)
      .def("estimate", &FollowingEstimator::estimate)
      .def("running", &FollowingEstimator::running)
      .def_prop_ro("model", &FollowingEstimator::model)
      .def_prop_ro("prior_std", &FollowingEstimator::prior_std)
      .def_prop_ro("noise_scale", &FollowingEstimator::noise_scale);
  m.def(
      "segment_jacobian",
      [](SegmentJacobian kind, const MotionModel& model, const SegmentLinearization& at,
         const Segment& segment) -> Eigen::MatrixXd {
        check_columns(at.by_parameter, model.size(), "the derivative of a segment");
        return segment_jacobian(kind, model, at, segment);
      },
      "kind"_a, "model"_a, "at"_a, "segment"_a, "Derivative of a segment: exact, or as the thesis prints it (6.7).");
}

}  // namespace slipwise::bindings
