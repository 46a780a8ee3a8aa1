// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/lie, slip and motion.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "checked_shapes.hpp"
#include "slipwise/filter/base_link_model.hpp"
#include "slipwise/lie/se2.hpp"
#include "slipwise/motion/disturbance_model.hpp"
#include "slipwise/motion/motion_model.hpp"
#include "slipwise/online/stamp_spacing.hpp"
#include "slipwise/slip/basis.hpp"
#include "slipwise/slip/force_terms.hpp"
#include "slipwise/slip/mixed_ahead.hpp"
#include "slipwise/slip/slip_surface.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

std::vector<std::string> texts(const Basis& basis, Channel channel) {
  std::vector<std::string> result;
  for (std::size_t i = basis.begin(channel); i < basis.end(channel); ++i) {
    result.push_back(basis.terms()[i].text());
  }
  return result;
}

}  // namespace

void bind_slip(nb::module_& m) {
  using Texts = std::vector<std::string>;
  nb::class_<SlipState>(m, "SlipState", "What slip depends on: v [m/s], omega [rad/s], gx, gy [m/s^2], vy [m/s].")
      .def(nb::init<double, double, double, double>(), "v"_a, "omega"_a, "gx"_a, "gy"_a)
      .def(nb::init<double, double, double, double, double>(), "v"_a, "omega"_a, "gx"_a, "gy"_a, "vy"_a);
  nb::class_<Basis>(m, "Basis", "Terms of the forward, sideways and angular slip rates.")
      .def(
          "__init__",
          [](Basis* self, std::string name, const Texts& lon, const Texts& lat, const Texts& ang) {
            new (self) Basis(std::move(name), lon, lat, ang);
          },
          "name"_a, "lon"_a, "lat"_a, "ang"_a)
      .def_prop_ro("name", &Basis::name)
      .def_prop_ro("size", &Basis::size)
      .def_prop_ro("sideways", &Basis::sideways)
      .def_prop_ro("by_heading", &Basis::by_heading, "Whether a term depends on the heading in the frame of the poses.")
      .def_prop_ro("lon", [](const Basis& b) { return texts(b, Channel::Lon); })
      .def_prop_ro("lat", [](const Basis& b) { return texts(b, Channel::Lat); })
      .def_prop_ro("ang", [](const Basis& b) { return texts(b, Channel::Ang); })
      .def(
          "features", [](const Basis& b, const SlipState& state) { return b.linearize_features(state).value; },
          "state"_a, "Feature of every parameter at one state, [parameters].");
  nb::class_<MixedAhead>(m, "MixedAhead", "Slip along a path whose surfaces are known with probabilities.")
      .def(
          "__init__",
          [](MixedAhead* self, const std::vector<double>& edges, const Eigen::MatrixXd& probabilities,
             const std::vector<Eigen::VectorXd>& slips, const std::vector<Eigen::MatrixXd>& covariances,
             const std::vector<Eigen::Vector3d>& noise_scales) {
            if (slips.size() != covariances.size() || slips.size() != noise_scales.size()) {
              throw std::invalid_argument("each surface ahead needs slip, its covariance and the scale of its noise");
            }
            std::vector<SurfaceMoments> surfaces;
            for (std::size_t i = 0; i < slips.size(); ++i) {
              surfaces.push_back({slips[i], covariances[i], noise_scales[i]});
            }
            new (self) MixedAhead(mix_ahead(edges, probabilities, surfaces));
          },
          "edges"_a, "probabilities"_a, "slips"_a, "covariances"_a, "noise_scales"_a,
          "Edges [m] between stretches, a row of probabilities for each stretch, and the moments of each surface.")
      .def_ro("slip", &MixedAhead::slip, "Where the path begins, [slip].")
      .def_prop_ro("edges", [](const MixedAhead& mixed) { return mixed.ahead.edges; })
      .def_prop_ro(
          "changes", [](const MixedAhead& mixed) { return mixed.ahead.changes; }, "Of slip at each edge.")
      .def_ro("noise_scale", &MixedAhead::noise_scale,
              "Factor of the noise's variances on each stretch, [stretches, 3].")
      .def_ro("directions", &MixedAhead::directions, "Independent errors of all stretches, [slip, stretches] each.");
  nb::enum_<ForceFrame>(m, "ForceFrame").value("Body", ForceFrame::Body).value("World", ForceFrame::World);
  m.def("with_force", &with_force, "basis"_a, "frame"_a, "The basis with the terms of a force.");
  nb::enum_<ForceAxis>(m, "ForceAxis")
      .value("Ahead", ForceAxis::Ahead)
      .value("Left", ForceAxis::Left)
      .value("Moment", ForceAxis::Moment)
      .value("WorldX", ForceAxis::WorldX)
      .value("WorldY", ForceAxis::WorldY);
  nb::class_<ForceTerm>(m, "ForceTerm", "A term of a force among those of a basis.")
      .def_ro("place", &ForceTerm::place, "Among the parameters.")
      .def_ro("axis", &ForceTerm::axis)
      .def_ro("sign", &ForceTerm::sign, "Of what a positive force does to its channel.");
  m.def("force_terms", &force_terms, "basis"_a, "The terms of a basis that are those of a force.");
  m.def("named_basis", &named_basis, "name"_a, "A basis by its published name.");
  m.def("basis_names", &basis_names, "Names of all bases that ship.");
  m.def(
      "slip_rate",
      [](const Basis& basis, const Eigen::VectorXd& alpha, const SlipState& state) {
        check_size(alpha, static_cast<Eigen::Index>(basis.size()), "a slip rate");
        return slip_rate(basis, alpha, state);
      },
      "basis"_a, "alpha"_a, "state"_a, "Slip rates (m/s, m/s, rad/s) at one state, [3].");
  m.def(
      "slip_rate_covariance",
      [](const Basis& basis, const Eigen::MatrixXd& covariance, const SlipState& state) {
        check_square(covariance, static_cast<Eigen::Index>(basis.size()), "the covariance of slip rates");
        return slip_rate_covariance(basis, covariance, state);
      },
      "basis"_a, "covariance"_a, "state"_a, "Covariance of the slip rates, [3, 3].");
}

void bind_motion(nb::module_& m) {
  nb::class_<ParameterInfo>(m, "ParameterInfo", "Name, unit and meaning of a parameter.")
      .def_ro("name", &ParameterInfo::name)
      .def_ro("unit", &ParameterInfo::unit)
      .def_ro("description", &ParameterInfo::description);
  m.def("lag_shows", &lag_shows, "log_mean"_a, "log_std"_a,
        "Whether a lag of the body [ln s] is surely long enough to be distinguished from a late clock.");
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
      .def_static(
          "with_lags",
          [](const Basis& basis, bool clock_offset) {
            return MotionModel(basis, {.clock_offset = clock_offset, .lags = true});
          },
          "basis"_a, "clock_offset"_a, "A lag per channel: of a body behind its wheels.")
      .def(
          "with_extrinsics",
          [](const MotionModel& model, bool sensor_extrinsics) {
            ActuatorParameters learned = model.learned();
            learned.sensor_extrinsics = sensor_extrinsics;
            return MotionModel(model.basis(), learned);
          },
          "sensor_extrinsics"_a,
          "The same with or without the pose of its pose sensor in base_link as three more parameters.")
      .def(
          "with_wheelbase",
          [](const MotionModel& model, double wheelbase) {
            ActuatorParameters learned = model.learned();
            learned.wheelbase = wheelbase;
            return MotionModel(model.basis(), learned);
          },
          "wheelbase"_a,
          "The same of a robot that steers, whose lags and delays act on the curvature of its path [m]; 0: on the yaw "
          "rate.")
      .def(
          "of_base_link",
          [](const MotionModel& model, const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance) {
            model.check(mean);
            check_square(covariance, model.size(), "the covariance of a model");
            KnownModel body = of_base_link(model, {mean, covariance});
            return std::tuple(std::move(body.estimate.mean), std::move(body.estimate.covariance));
          },
          "mean"_a, "covariance"_a,
          "Mean and covariance [parameters] without the place and clock of the pose sensor; delays to wheel speeds "
          "that are stamped late become those to the motion.")
      .def(
          "lateness",
          [](const MotionModel& model, const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance, double spacing) {
            model.check(mean);
            check_square(covariance, model.size(), "the covariance of a model");
            const auto late = learned_lateness(model, {mean, covariance}, spacing);
            return late ? std::optional(std::tuple(late->mean, late->std)) : std::nullopt;
          },
          "mean"_a, "covariance"_a, "spacing"_a,
          "How much later poses come than wheel speeds of a stamp spacing [s], and its standard deviation [s]; lags of "
          "the body that are too short to show count as lateness. None where no clock offset is learned.")
      .def_prop_ro("wheelbase", [](const MotionModel& model) { return model.learned().wheelbase; })
      .def_prop_ro("basis", &MotionModel::basis)
      .def_prop_ro("dynamics", [](const MotionModel& model) { return model.learned().dynamics; })
      .def_prop_ro("delays", [](const MotionModel& model) { return model.learned().delays; })
      .def_prop_ro("lags", [](const MotionModel& model) { return model.learned().lags; })
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

void bind_lie(nb::module_& m) {
  nb::class_<Pose2>(m, "Pose2", "A planar pose (x [m], y [m], theta [rad], unwrapped).")
      .def(nb::init<double, double, double>(), "x"_a, "y"_a, "theta"_a)
      .def_ro("x", &Pose2::x)
      .def_ro("y", &Pose2::y)
      .def_ro("theta", &Pose2::theta)
      .def("vector", &Pose2::vector);
  m.def("wrap_angle", &wrap_angle, "angle"_a, "The angle in (-pi, pi] [rad].");
  m.def("exp", &exp, "tangent"_a, "The pose reached by a constant twist, tangent = twist * time.");
  m.def("log", &log, "pose"_a, "The tangent of a pose, turning by at most half a turn.");
  m.def("compose", &compose, "a_b"_a, "b_c"_a, "T_a_c = T_a_b T_b_c.");
  m.def("inverse", &inverse, "pose"_a);
  m.def("between", &between, "world_a"_a, "world_b"_a, "T_a_b from T_w_a and T_w_b.");
}

}  // namespace slipwise::bindings
