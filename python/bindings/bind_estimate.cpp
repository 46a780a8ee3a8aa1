// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/filter and disturbance, and of the actuator that is learned from wheel speeds.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "checked_shapes.hpp"
#include "slipwise/disturbance/ahead_prediction.hpp"
#include "slipwise/filter/causal_filter.hpp"
#include "slipwise/filter/iekf.hpp"
#include "slipwise/filter/observability.hpp"
#include "slipwise/filter/prior.hpp"
#include "slipwise/filter/rts_smoother.hpp"
#include "slipwise/filter/weighting.hpp"
#include "slipwise/hypotheses/model_average.hpp"
#include "slipwise/identify/actuator_filter.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

/// As a chart (x, y, theta), whatever sensors measure.
ExpectedPose as_chart(const ExpectedPose& expected, const Segment& segment) {
  const Directions directions = directions_of(segment.measured);
  return {chart_of(directions, expected.pose), chart_covariance(directions, expected.covariance)};
}

void bind_filter_settings(nb::module_& m) {
  nb::class_<IekfSettings>(m, "IekfSettings")
      .def(nb::init<>())
      .def_rw("iterations", &IekfSettings::iterations)
      .def_rw("tolerance", &IekfSettings::tolerance)
      .def_rw("halvings", &IekfSettings::halvings)
      .def_rw("huber", &IekfSettings::huber)
      .def_rw("gate", &IekfSettings::gate);
  nb::class_<PriorSettings>(m, "PriorSettings")
      .def(nb::init<>())
      .def_rw("slip_fraction", &PriorSettings::slip_fraction)
      .def_rw("straight_side_slip_std", &PriorSettings::straight_side_slip_std)
      .def_rw("clock_offset_std", &PriorSettings::clock_offset_std)
      .def_rw("sensor", &PriorSettings::sensor)
      .def_rw("extrinsics_std", &PriorSettings::extrinsics_std)
      .def_rw("sensor_yaw_std", &PriorSettings::sensor_yaw_std)
      .def_rw("time_constant", &PriorSettings::time_constant)
      .def_rw("delay", &PriorSettings::delay)
      .def_rw("log_std", &PriorSettings::log_std)
      .def_rw("gain_std", &PriorSettings::gain_std)
      .def_rw("slow_fraction_std", &PriorSettings::slow_fraction_std)
      .def_rw("slow_time_constant", &PriorSettings::slow_time_constant);
  nb::class_<NoiseSettings>(m, "NoiseSettings")
      .def(nb::init<>())
      .def_rw("shape", &NoiseSettings::shape)
      .def_rw("adapt", &NoiseSettings::adapt)
      .def_rw("prior_segments", &NoiseSettings::prior_segments)
      .def_rw("forgetting_time", &NoiseSettings::forgetting_time)
      .def_rw("largest", &NoiseSettings::largest);
  nb::class_<BodyForceSettings>(m, "BodyForceSettings")
      .def(nb::init<>())
      .def_rw("time_constant", &BodyForceSettings::time_constant)
      .def_rw("std", &BodyForceSettings::std)
      .def_rw("turn_std", &BodyForceSettings::turn_std)
      .def_rw("arm", &BodyForceSettings::arm);
  nb::class_<BodyForce>(m, "BodyForce", "The states of a force among the parameters of a model.")
      .def(nb::init<const Basis&, const BodyForceSettings&>(), "basis"_a, "settings"_a)
      .def_prop_ro("places", &BodyForce::places)
      .def(
          "passed",
          [](const BodyForce& force, Estimate estimate, double seconds) {
            check_square(estimate.covariance, estimate.mean.size(), "the covariance beside a force");
            for (const Eigen::Index place : force.places()) {
              if (place >= estimate.mean.size()) {
                throw std::invalid_argument("the estimate lacks the states of the force: it is of another model");
              }
            }
            force.pass(estimate, seconds);
            return estimate;
          },
          "estimate"_a, "seconds"_a, "The estimate after some time without a measurement [s].");
  nb::class_<BranchSettings>(m, "BranchSettings").def(nb::init<>()).def_rw("follow", &BranchSettings::follow);
  nb::class_<CausalFilterSettings>(m, "CausalFilterSettings")
      .def(nb::init<>())
      .def_rw("prior", &CausalFilterSettings::prior)
      .def_rw("iekf", &CausalFilterSettings::iekf)
      .def_rw("noise", &CausalFilterSettings::noise)
      .def_rw("force", &CausalFilterSettings::force)
      .def_rw("branches", &CausalFilterSettings::branches);
  nb::class_<WeightingSettings>(m, "WeightingSettings")
      .def(nb::init<>())
      .def_rw("learning_rate", &WeightingSettings::learning_rate)
      .def_rw("fraction", &WeightingSettings::fraction);
  nb::class_<ModelAverageSettings>(m, "ModelAverageSettings")
      .def(nb::init<>())
      .def_rw("weighting", &ModelAverageSettings::weighting)
      .def_rw("largest_basis", &ModelAverageSettings::largest_basis)
      .def_rw("surfaces", &ModelAverageSettings::surfaces);
}

void bind_filter_results(nb::module_& m) {
  nb::class_<Estimate>(m, "Estimate", "Gaussian posterior about a parameter vector.")
      .def(
          "__init__",
          [](Estimate* self, Eigen::VectorXd mean, Eigen::MatrixXd covariance) {
            check_square(covariance, mean.size(), "the covariance of an estimate");
            new (self) Estimate{std::move(mean), std::move(covariance)};
          },
          "mean"_a, "covariance"_a)
      .def_ro("mean", &Estimate::mean)
      .def_ro("covariance", &Estimate::covariance);
  nb::enum_<Status>(m, "Status")
      .value("Converged", Status::Converged)
      .value("Downweighted", Status::Downweighted)
      .value("Rejected", Status::Rejected)
      .value("NotConverged", Status::NotConverged);
  nb::class_<IekfUpdate>(m, "IekfUpdate", "One segment's update.")
      .def_ro("estimate", &IekfUpdate::estimate)
      .def_prop_ro("innovation", [](const IekfUpdate& u) -> Eigen::VectorXd { return u.innovation; })
      .def_prop_ro("innovation_covariance",
                   [](const IekfUpdate& u) -> Eigen::MatrixXd { return u.innovation_covariance; })
      .def_ro("nis", &IekfUpdate::nis)
      .def_ro("weight", &IekfUpdate::weight)
      .def_ro("status", &IekfUpdate::status);
  nb::class_<AverageState>(m, "AverageState", "The average of several models over the union of their terms.")
      .def_ro("estimate", &AverageState::estimate)
      .def_ro("prior_std", &AverageState::prior_std)
      .def_ro("variance_ratio", &AverageState::variance_ratio)
      .def_ro("noise_scale", &AverageState::noise_scale)
      .def_ro("weights", &AverageState::weights);
}

}  // namespace

void bind_estimate(nb::module_& m) {
  bind_filter_settings(m);
  bind_filter_results(m);
  m.def(
      "iekf_update",
      [](const MotionModel& model, const Estimate& prior, const InputHistory& inputs, const Segment& segment,
         const Eigen::Matrix3d& noise, const IekfSettings& settings) {
        return iekf_update(model, prior, inputs, segment, RowsCovariance(noise), settings);
      },
      "model"_a, "prior"_a, "inputs"_a, "segment"_a, "noise"_a, "settings"_a);
  m.def(
      "prior_estimate",
      [](const MotionModel& model, double v, double omega, const PriorSettings& settings) {
        return prior_estimate(model, {v, omega}, settings);
      },
      "model"_a, "v"_a, "omega"_a, "settings"_a,
      "The posterior before any data, at reference speeds v [m/s], omega [rad/s].");
  m.def(
      "slip_prior_std",
      [](const Basis& basis, double v, double omega, double fraction) {
        return slip_prior_std(basis, {v, omega}, fraction);
      },
      "basis"_a, "v"_a, "omega"_a, "fraction"_a, "Prior standard deviation of each slip parameter, [parameters].");
  m.def(
      "prediction_covariance",
      [](const SegmentLinearization& at, const Eigen::MatrixXd& parameters, const MotionNoise& shape,
         const Eigen::Vector3d& scale) {
        check_square(parameters, at.by_parameter.cols(), "the covariance of a prediction's parameters");
        return chart_covariance(at.path.directions(), prediction_covariance(at, parameters, shape, scale));
      },
      "at"_a, "parameters"_a, "shape"_a, "scale"_a, "Covariance of a predicted chart (x, y, theta), [3, 3].");
  nb::class_<CorrelatedPair>(m, "CorrelatedPair", "Two parameters whose errors go together.")
      .def_ro("first", &CorrelatedPair::first)
      .def_ro("second", &CorrelatedPair::second)
      .def_ro("correlation", &CorrelatedPair::correlation);
  m.def(
      "correlated_pairs",
      [](const Eigen::MatrixXd& covariance, double least) {
        check_square(covariance, covariance.rows(), "a covariance");
        return correlated_pairs(covariance, least);
      },
      "covariance"_a, "least"_a, "Pairs of parameters with at least this correlation, the closest first.");
  nb::class_<SlipChange>(m, "SlipChange", "Whether slip jumped since the terrain counted as changed last.")
      .def(nb::init<>())
      .def_ro("log_odds", &SlipChange::log_odds)
      .def_ro("segments", &SlipChange::segments)
      .def_ro("alarm", &SlipChange::alarm);
  nb::class_<ModelAverage>(m, "ModelAverage", "Causal filters of several bases, weighted by how well they predict.")
      .def(
          "__init__",
          [](ModelAverage* self, std::string name, const std::vector<Basis>& bases, bool dynamics, bool clock_offset,
             bool sensor_extrinsics, const CausalFilterSettings& filter, const ModelAverageSettings& settings) {
            new (self) ModelAverage(
                std::move(name), bases,
                {.dynamics = dynamics, .clock_offset = clock_offset, .sensor_extrinsics = sensor_extrinsics}, filter,
                settings);
          },
          "name"_a, "bases"_a, "dynamics"_a, "clock_offset"_a, "sensor_extrinsics"_a, "filter"_a, "settings"_a)
      .def_static(
          "with_delays",
          [](std::string name, const std::vector<Basis>& bases, bool sensor_extrinsics,
             const CausalFilterSettings& filter, const ModelAverageSettings& settings) {
            return ModelAverage(std::move(name), bases, {.sensor_extrinsics = sensor_extrinsics, .delays = true},
                                filter, settings);
          },
          "name"_a, "bases"_a, "sensor_extrinsics"_a, "filter"_a, "settings"_a,
          "Of delays alone, without an actuator model.")
      .def("learn", &ModelAverage::learn, "inputs"_a, "segment"_a)
      .def("state", &ModelAverage::state)
      .def_prop_ro("change", [](const ModelAverage& average) { return SlipChange(average.change()); })
      .def_prop_ro("model", &ModelAverage::model)
      .def_prop_ro("reference_speeds", [](const ModelAverage& average) {
        const ReferenceSpeeds speeds = average.reference_speeds();
        return std::pair(speeds.v, speeds.omega);
      });
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
         const std::vector<Segment>& segments, const std::vector<Eigen::MatrixXd>& noise, const DriftSettings& drift,
         const IekfSettings& iekf) {
        check_inputs(inputs, segments.size(), noise.size());
        std::vector<BatchDatum> data;
        for (std::size_t i = 0; i < segments.size(); ++i) {
          const Eigen::Index rows = rows_of(segments[i].measured).size();
          if (noise[i].rows() != rows || noise[i].cols() != rows) {
            throw std::invalid_argument("the noise of a segment must have a row for each number measured of it");
          }
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

void bind_slip_disturbance(nb::module_& m) {
  nb::class_<DisturbanceSettings>(m, "DisturbanceSettings")
      .def(nb::init<>())
      .def_rw("fractions", &DisturbanceSettings::fractions)
      .def_rw("time_constants", &DisturbanceSettings::time_constants)
      .def_rw("white", &DisturbanceSettings::white)
      .def_rw("weighting", &DisturbanceSettings::weighting);
  m.attr("UNIDENTIFIABLE_RATIO") = kUnidentifiableRatio;
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
      .def_prop_ro("pose", [](const ExpectedPose& e) -> Eigen::VectorXd { return e.pose; })
      .def_prop_ro("covariance", [](const ExpectedPose& e) -> Eigen::MatrixXd { return e.covariance; });
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
             const SlipNow& now, const Segment& segment) {
            return as_chart(slip.predict(posterior, now, {.inputs = inputs, .segment = segment}), segment);
          },
          "posterior"_a, "inputs"_a, "now"_a, "segment"_a, "Predicts a segment from where slip is.")
      .def_prop_ro("law", &DisturbanceFilter::law);
  m.def(
      "predict_ahead",
      [](const DisturbanceFilter& slip, const MotionPosterior& posterior, const InputHistory& inputs,
         const SlipNow& now, const Segment& segment, const MixedAhead& ahead) {
        return as_chart(predict_ahead(slip, posterior, now, {.inputs = inputs, .segment = segment}, ahead), segment);
      },
      "slip"_a, "posterior"_a, "inputs"_a, "now"_a, "segment"_a, "ahead"_a,
      "Where a segment over several surfaces is expected to end.");
}

}  // namespace slipwise::bindings
