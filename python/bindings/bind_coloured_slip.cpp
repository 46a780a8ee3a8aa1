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
  nb::class_<MotionPosterior>(m, "MotionPosterior", "What is known of a motion model at one time.")
      .def(
          "__init__",
          [](MotionPosterior* self, const MotionModel& model, const Estimate& estimate,
             const Eigen::VectorXd& prior_std, const MotionNoise& shape, const Eigen::Vector3d& noise_scale) {
            check_estimate(model, estimate);
            check_size(prior_std, model.size(), "the prior of a model");
            new (self) MotionPosterior{model, estimate, prior_std, shape, noise_scale};
          },
          "model"_a, "estimate"_a, "prior_std"_a, "noise"_a, "noise_scale"_a)
      .def_ro("model", &MotionPosterior::model)
      .def_ro("estimate", &MotionPosterior::estimate)
      .def_ro("prior_std", &MotionPosterior::prior_std)
      .def_ro("noise", &MotionPosterior::noise)
      .def_ro("noise_scale", &MotionPosterior::noise_scale)
      .def_ro("variance_ratio", &MotionPosterior::variance_ratio)
      .def_ro("basis_weights", &MotionPosterior::basis_weights)
      .def_prop_ro("structure", [](const MotionPosterior& posterior) { return static_cast<int>(posterior.structure); });
  nb::class_<ExpectedPose>(m, "ExpectedPose", "Where a segment is expected to end.")
      .def_ro("pose", &ExpectedPose::pose)
      .def_ro("covariance", &ExpectedPose::covariance);
  nb::class_<SlipNow>(m, "SlipNow", "Where slip is at some moment, under each guess of how it wanders.");
  nb::class_<ColouredSlip>(m, "ColouredSlip", "Slip that wanders about what was learned.")
      .def(nb::init<const ColouredSlipSettings&>(), "settings"_a)
      .def(nb::init<const WanderLaw&>(), "law"_a)
      .def(nb::init<const ColouredSlip&>(), "other"_a)
      .def(
          "learn",
          [](ColouredSlip& slip, const MotionPosterior& belief, const InputTrack& inputs, const SlipNow& now,
             const Segment& segment) { slip.learn(belief, now, {.inputs = inputs, .segment = segment}); },
          "belief"_a, "inputs"_a, "now"_a, "segment"_a,
          "Weights the candidates by a segment, predicted from where slip was.")
      .def(
          "now",
          [](const ColouredSlip& slip, const MotionPosterior& belief, const InputTrack& inputs,
             const std::vector<Segment>& recent) {
            std::vector<DrivenSegment> driven;
            for (const Segment& segment : recent) {
              driven.push_back({.inputs = inputs, .segment = segment});
            }
            return slip.now(belief, driven);
          },
          "belief"_a, "inputs"_a, "recent"_a, "What recent segments say of the slip after them.")
      .def(
          "predict",
          [](const ColouredSlip& slip, const MotionPosterior& belief, const InputTrack& inputs, const SlipNow& now,
             const Segment& segment) { return slip.predict(belief, now, {.inputs = inputs, .segment = segment}); },
          "belief"_a, "inputs"_a, "now"_a, "segment"_a, "Predicts a segment from where slip is.")
      .def_prop_ro("law", &ColouredSlip::law);
}

}  // namespace slipwise::bindings
