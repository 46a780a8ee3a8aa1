// SPDX-License-Identifier: Apache-2.0
// Bindings of slip that wanders about what was learned.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "checked_shapes.hpp"
#include "slipwise/estimate/coloured_slip.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {

void bind_coloured_slip(nb::module_& m) {
  nb::class_<ColouredSlipSettings>(m, "ColouredSlipSettings")
      .def(nb::init<>())
      .def_rw("fractions", &ColouredSlipSettings::fractions)
      .def_rw("time_constants", &ColouredSlipSettings::time_constants)
      .def_rw("white", &ColouredSlipSettings::white)
      .def_rw("weighing", &ColouredSlipSettings::weighing);
  nb::class_<MotionBelief>(m, "MotionBelief", "A model as it is believed before the segments that it is asked about.")
      .def(
          "__init__",
          [](MotionBelief* self, const MotionModel& model, const Estimate& estimate, const Eigen::VectorXd& prior_std,
             const MotionNoise& shape, const Eigen::Vector3d& noise_scale) {
            check_estimate(model, estimate);
            check_size(prior_std, model.size(), "the prior of a model");
            new (self) MotionBelief{model, estimate, prior_std, shape, noise_scale};
          },
          "model"_a, "estimate"_a, "prior_std"_a, "shape"_a, "noise_scale"_a);
  nb::class_<ExpectedPose>(m, "ExpectedPose", "Where a segment is expected to end.")
      .def_ro("pose", &ExpectedPose::pose)
      .def_ro("covariance", &ExpectedPose::covariance);
  nb::class_<SlipNow>(m, "SlipNow", "Where slip is at some moment, under each guess of how it wanders.");
  nb::class_<ColouredSlip>(m, "ColouredSlip", "Slip that wanders about what was learned.")
      .def(nb::init<const ColouredSlipSettings&>(), "settings"_a)
      .def(nb::init<const WanderLaw&>(), "law"_a)
      .def(nb::init<const ColouredSlip&>(), "other"_a)
      .def("learn", &ColouredSlip::learn, "belief"_a, "inputs"_a, "now"_a, "segment"_a,
           "Weighs the candidates by a segment, foretold from where slip was.")
      .def(
          "now",
          [](const ColouredSlip& slip, const MotionBelief& belief, const InputTrack& inputs,
             const std::vector<Segment>& recent) { return slip.now(belief, inputs, recent); },
          "belief"_a, "inputs"_a, "recent"_a, "What recent segments say of the slip after them.")
      .def("predict", &ColouredSlip::predict, "belief"_a, "inputs"_a, "now"_a, "segment"_a,
           "Predicts a segment from where slip is.")
      .def_prop_ro("law", &ColouredSlip::law);
}

}  // namespace slipwise::bindings
