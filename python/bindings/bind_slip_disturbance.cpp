// SPDX-License-Identifier: Apache-2.0
// Bindings of the slip disturbance.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "checked_shapes.hpp"
#include "slipwise/disturbance/ahead_prediction.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {

void bind_slip_disturbance(nb::module_& m) {
  nb::class_<DisturbanceSettings>(m, "DisturbanceSettings")
      .def(nb::init<>())
      .def_rw("fractions", &DisturbanceSettings::fractions)
      .def_rw("time_constants", &DisturbanceSettings::time_constants)
      .def_rw("white", &DisturbanceSettings::white)
      .def_rw("weighting", &DisturbanceSettings::weighting);
  nb::class_<MotionPosterior>(m, "MotionPosterior", "The posterior of a motion model at one time.")
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
  nb::class_<SlipNow>(m, "SlipNow", "Where slip is at some moment, under each guess of how it disturbed.");
  nb::class_<DisturbanceFilter>(m, "DisturbanceFilter", "The slip disturbance about what was learned.")
      .def(nb::init<const DisturbanceSettings&>(), "settings"_a)
      .def(nb::init<const DisturbanceModel&>(), "law"_a)
      .def(nb::init<const DisturbanceFilter&>(), "other"_a)
      .def(
          "learn",
          [](DisturbanceFilter& slip, const MotionPosterior& posterior, const InputHistory& inputs, const SlipNow& now,
             const Segment& segment) { slip.learn(posterior, now, {.inputs = inputs, .segment = segment}); },
          "posterior"_a, "inputs"_a, "now"_a, "segment"_a,
          "Weights the candidates by a segment, predicted from where slip was.")
      .def(
          "now",
          [](const DisturbanceFilter& slip, const MotionPosterior& posterior, const InputHistory& inputs,
             const std::vector<Segment>& recent) {
            std::vector<DrivenSegment> driven;
            for (const Segment& segment : recent) {
              driven.push_back({.inputs = inputs, .segment = segment});
            }
            return slip.now(posterior, driven);
          },
          "posterior"_a, "inputs"_a, "recent"_a, "What recent segments say of the slip after them.")
      .def(
          "predict",
          [](const DisturbanceFilter& slip, const MotionPosterior& posterior, const InputHistory& inputs,
             const SlipNow& now,
             const Segment& segment) { return slip.predict(posterior, now, {.inputs = inputs, .segment = segment}); },
          "posterior"_a, "inputs"_a, "now"_a, "segment"_a, "Predicts a segment from where slip is.")
      .def_prop_ro("law", &DisturbanceFilter::law);
  m.def(
      "predict_ahead",
      [](const DisturbanceFilter& slip, const MotionPosterior& posterior, const InputHistory& inputs,
         const SlipNow& now, const Segment& segment, const MixedAhead& ahead) {
        return predict_ahead(slip, posterior, now, {.inputs = inputs, .segment = segment}, ahead);
      },
      "slip"_a, "posterior"_a, "inputs"_a, "now"_a, "segment"_a, "ahead"_a,
      "Where a segment over several surfaces is expected to end.");
}

}  // namespace slipwise::bindings
