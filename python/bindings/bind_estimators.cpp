// SPDX-License-Identifier: Apache-2.0
// Bindings of the estimators behind one interface, and of the smoother.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <stdexcept>

#include "bindings.hpp"
#include "checked_shapes.hpp"
#include "slipwise/filter/rts_smoother.hpp"
#include "slipwise/identify/actuator_filter.hpp"
#include "slipwise/thesis/estimator.hpp"
#include "slipwise/thesis/following_estimator.hpp"

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

}  // namespace

void bind_estimators(nb::module_& m) {
  bind_estimator_settings(m);
  bind_smoother(m);
  nb::class_<Estimator>(m, "Estimator", "An estimator of a model's parameters.")
      .def("learn", &Estimator::learn, "inputs"_a, "segment"_a)
      .def("estimate", &Estimator::estimate)
      .def("running", &Estimator::running, "What learning goes on from: the estimate, unless that fits all segments.")
      .def_prop_ro("model", &Estimator::model);
  m.def("estimator_names", &estimator_names, "Names that make_estimator knows.");
  m.def("learns_overlapping_segments", &learns_overlapping_segments, "name"_a,
        "True for those that the thesis feeds with overlapping segments at 20 Hz.");
  m.def("fits_all_segments", &fits_all_segments, "name"_a,
        "True for those whose estimate is a fit over all segments at once, off-line.");
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
  nb::class_<ActuatorUpdate>(m, "ActuatorUpdate", "How a window of wheel speeds was predicted.")
      .def_ro("nis", &ActuatorUpdate::nis);
  nb::class_<ActuatorFilter>(m, "ActuatorFilter", "The actuator, learned from commands and wheel speeds.")
      .def(nb::init<const CausalFilterSettings&>(), "settings"_a)
      .def("learn", &ActuatorFilter::learn, "inputs"_a, "wheels"_a, "start"_a, "end"_a,
           "Learns the wheel speeds from start to end [s], in input stamps.")
      .def("estimate", &ActuatorFilter::estimate)
      .def_prop_ro("model", &ActuatorFilter::model)
      .def_prop_ro("prior_std", &ActuatorFilter::prior_std);
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
