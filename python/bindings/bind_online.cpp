// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/online: the streaming learner.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "checked_shapes.hpp"
#include "locked_learner.hpp"
#include "pose_sources.hpp"
#include "sample_rows.hpp"
#include "slipwise/online/motion_learner.hpp"
#include "slipwise/online/recording.hpp"
#include "slipwise/online/student_t.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

void bind_learner_settings(nb::module_& m) {
  nb::class_<SegmentRules>(m, "SegmentRules", "When two poses and the inputs between them make a segment.")
      .def(nb::init<>())
      .def_rw("late_factor", &SegmentRules::late_factor)
      .def_rw("length_tolerance", &SegmentRules::length_tolerance)
      .def_rw("still_speed", &SegmentRules::still_speed);
  bind_sources(m);
  nb::class_<StreamSettings>(m, "StreamSettings", "How measurements become segments.")
      .def(nb::init<>())
      .def_rw("from_commands", &StreamSettings::from_commands)
      .def_rw("segment_length", &StreamSettings::segment_length)
      .def_rw("whole_frames", &StreamSettings::whole_frames)
      .def_rw("stride", &StreamSettings::stride)
      .def_rw("rules", &StreamSettings::rules)
      .def_rw("unknown_after", &StreamSettings::unknown_after)
      .def_rw("latency", &StreamSettings::latency)
      .def_rw("horizons", &StreamSettings::horizons)
      .def_rw("embargo", &StreamSettings::embargo)
      .def_rw("sensor", &StreamSettings::sensor)
      .def_rw("car", &StreamSettings::car)
      .def_rw("sources", &StreamSettings::sources)
      .def_rw("heading_only", &StreamSettings::heading_only);
  nb::class_<HypothesisSettings>(m, "HypothesisSettings", "What the learner learns.")
      .def(nb::init<>())
      .def_rw("bases", &HypothesisSettings::bases)
      .def_rw("dynamics", &HypothesisSettings::dynamics)
      .def_rw("clock_offset", &HypothesisSettings::clock_offset)
      .def_rw("sensor_extrinsics", &HypothesisSettings::sensor_extrinsics)
      .def_rw("cascaded", &HypothesisSettings::cascaded)
      .def_rw("direct", &HypothesisSettings::direct)
      .def_rw("baseline", &HypothesisSettings::baseline)
      .def_rw("wheelbase", &HypothesisSettings::wheelbase)
      .def_prop_ro("several", &HypothesisSettings::several)
      .def_rw("filter", &HypothesisSettings::filter)
      .def_rw("average", &HypothesisSettings::average);
  nb::class_<LearnerSettings>(m, "LearnerSettings", "All that changes what a learner learns.")
      .def(nb::init<>())
      .def_rw("stream", &LearnerSettings::stream)
      .def_rw("hypotheses", &LearnerSettings::hypotheses)
      .def_rw("disturbance", &LearnerSettings::disturbance)
      .def_rw("learn_disturbance", &LearnerSettings::learn_disturbance);
}

void bind_learner_results(nb::module_& m) {
  nb::class_<StudentCalibration>(m, "StudentCalibration", "Fits a Student t to the errors of predictions.")
      .def(nb::init<>())
      .def("learn", &StudentCalibration::learn, "squared"_a,
           "Takes in the squared Mahalanobis length of an error in its reported covariance.")
      .def("fitted", &StudentCalibration::fitted);
  nb::class_<StudentT>(m, "StudentT", "A multivariate Student t around a prediction.")
      .def_ro("inflation", &StudentT::inflation)
      .def_ro("dof", &StudentT::dof);
  nb::class_<HeldOutPrediction>(m, "HeldOutPrediction", "A prediction of one horizon, and what was measured.")
      .def_ro("horizon", &HeldOutPrediction::horizon);
  nb::class_<HeldOutPredictions>(m, "HeldOutPredictions", "The last predictions of one horizon.")
      .def("__len__", &HeldOutPredictions::size)
      .def(
          "columns", [](const HeldOutPredictions& predictions) { return HeldOutColumns(predictions); },
          "Their numbers, as arrays.");
  nb::class_<HeldOutColumns>(m, "HeldOutColumns",
                             "Predictions and what was measured, an array for each kind of number.")
      .def(nb::init<const std::vector<const HeldOutPrediction*>&>(), "predictions"_a)
      .def_ro("run", &HeldOutColumns::run)
      .def_ro("structure", &HeldOutColumns::structure)
      .def_ro("start", &HeldOutColumns::start)
      .def_ro("end", &HeldOutColumns::end)
      .def_ro("inflation", &HeldOutColumns::inflation)
      .def_ro("dof", &HeldOutColumns::dof)
      .def_ro("nominal_nis", &HeldOutColumns::nominal_nis)
      .def_ro("learned_until", &HeldOutColumns::learned_until)
      .def_ro("pose", &HeldOutColumns::pose)
      .def_ro("measured", &HeldOutColumns::measured)
      .def_ro("baseline", &HeldOutColumns::baseline)
      .def_ro("in_sample", &HeldOutColumns::in_sample)
      .def_ro("covariance", &HeldOutColumns::covariance, "[N, 9], row by row.");
  nb::class_<StructureUpdate>(m, "StructureUpdate", "How one structure took a segment in.")
      .def_ro("nis", &StructureUpdate::nis)
      .def_ro("weight", &StructureUpdate::weight)
      .def_ro("change", &StructureUpdate::change);
  nb::class_<PredictedPath>(m, "PredictedPath", "A path that is predicted from now on.")
      .def_ro("start", &PredictedPath::start)
      .def_ro("t", &PredictedPath::t)
      .def_ro("poses", &PredictedPath::poses)
      .def_ro("covariances", &PredictedPath::covariances)
      .def_ro("students", &PredictedPath::students)
      .def_prop_ro("structure", [](const PredictedPath& path) { return static_cast<int>(path.structure); });
  nb::class_<ActuatorLimits>(m, "ActuatorLimits", "What a search for limits found.")
      .def_ro("search", &ActuatorLimits::search)
      .def_prop_ro("posterior",
                   [](const ActuatorLimits& limits) -> std::optional<MotionPosterior> {
                     return limits.posterior ? std::optional(*limits.posterior) : std::nullopt;
                   })
      .def_ro("score", &ActuatorLimits::score);
  nb::class_<MeasuredRates>(m, "MeasuredRates", "Rates of the body that 99 % of the motion stayed below.")
      .def_ro("speed", &MeasuredRates::speed)
      .def_ro("yaw_rate", &MeasuredRates::yaw_rate)
      .def_ro("acceleration", &MeasuredRates::acceleration)
      .def_ro("turning", &MeasuredRates::turning)
      .def_ro("seconds", &MeasuredRates::seconds);
  nb::class_<LearnedModel>(m, "LearnedModel", "What was learned so far.")
      .def_prop_ro("motion", [](const LearnedModel& model) { return *model.known.motion; })
      .def_prop_ro("slip", [](const LearnedModel& model) { return *model.known.slip; })
      .def_prop_ro("disturbance", [](const LearnedModel& model) { return *model.known.disturbance; })
      .def_ro("students", &LearnedModel::students)
      .def_ro("held_out", &LearnedModel::held_out)
      .def_ro("weights", &LearnedModel::weights)
      .def_prop_ro("range", [](const LearnedModel& model) { return model.range.inputs(); })
      .def_prop_ro("rates", [](const LearnedModel& model) { return model.range.rates(); })
      .def_prop_ro("held", [](const LearnedModel& model) { return model.range.held(); })
      .def_prop_ro("steepest", [](const LearnedModel& model) { return model.range.steepest(); })
      .def_ro("seconds", &LearnedModel::seconds)
      .def_ro("segments", &LearnedModel::segments)
      .def_ro("rejected", &LearnedModel::rejected)
      .def_ro("car", &LearnedModel::car)
      .def_ro("evidence", &LearnedModel::evidence)
      .def(
          "predicted_again",
          [](const LearnedModel& model, std::size_t horizon, const ActuatorLimits* limits) {
            if (limits != nullptr && limits->posterior) {
              return model.targets.predicted_by(*limits->posterior, limits->search.drive.limits, horizon);
            }
            return model.targets.predicted_by(*model.known.motion, {}, horizon);
          },
          "horizon"_a, "limits"_a.none(),
          "Poses [N, 3] that the model, behind limits where they were kept, predicts of the last targets of a "
          "horizon.");
}

void bind_events(nb::module_& m) {
  nb::enum_<LearnerEvent::Kind>(m, "EventKind", "What a learner has to say.")
      .value("SegmentLearned", LearnerEvent::Kind::SegmentLearned)
      .value("Rejected", LearnerEvent::Kind::Rejected)
      .value("TerrainChange", LearnerEvent::Kind::TerrainChange)
      .value("HeldOut", LearnerEvent::Kind::HeldOut)
      .value("Refit", LearnerEvent::Kind::Refit);
  nb::class_<LearnerEvent>(m, "LearnerEvent", "Something that a learner has to say.")
      .def_ro("kind", &LearnerEvent::kind)
      .def_ro("run", &LearnerEvent::run)
      .def_ro("t", &LearnerEvent::t)
      .def_ro("stream", &LearnerEvent::stream)
      .def_prop_ro("reason", [](const LearnerEvent& event) { return reason_name(event.reason); })
      .def_prop_ro("reason_text", [](const LearnerEvent& event) { return reason_text(event.reason); })
      .def_ro("updates", &LearnerEvent::updates)
      .def_ro("weights", &LearnerEvent::weights)
      .def_ro("surfaces", &LearnerEvent::surfaces)
      .def(
          "posterior",
          [](const LearnerEvent& event, std::size_t structure) -> std::optional<MotionPosterior> {
            const auto& posterior = event.posteriors.at(structure);
            return posterior ? std::optional(*posterior) : std::nullopt;
          },
          "structure"_a, "What a structure knows after the segment; None where it is not tried.")
      .def_prop_ro("prediction", [](const LearnerEvent& event) -> std::optional<HeldOutPrediction> {
        return event.prediction ? std::optional(*event.prediction) : std::nullopt;
      });
}

void bind_odometry(nb::module_& m) {
  nb::class_<Odometry>(m, "Odometry", "Where the robot is, and how it moves, as nav_msgs/Odometry says it.")
      .def_ro("t", &Odometry::t)
      .def_ro("frame", &Odometry::frame)
      .def_ro("pose", &Odometry::pose)
      .def_ro("covariance", &Odometry::covariance)
      .def_prop_ro(
          "twist",
          [](const Odometry& odometry) {
            return Eigen::Vector3d(odometry.twist.v, odometry.twist.vy, odometry.twist.omega);
          },
          "(v, vy, omega) [m/s, m/s, rad/s].")
      .def_ro("twist_covariance", &Odometry::twist_covariance)
      .def_ro("since_pose", &Odometry::since_pose);
  nb::class_<MotionState>(m, "MotionState", "How the robot moves beside what was expected of it.")
      .def_ro("stuck", &MotionState::stuck)
      .def_ro("fraction", &MotionState::fraction)
      .def_ro("since", &MotionState::since);
}

void bind_surface_events(nb::module_& m) {
  nb::class_<DatedSurfaceEvent>(m, "DatedSurfaceEvent", "Something that happened to the surfaces, and when.")
      .def_prop_ro("kind", [](const DatedSurfaceEvent& dated) { return dated.event.kind; })
      .def_prop_ro("name", [](const DatedSurfaceEvent& dated) { return dated.event.name; })
      .def_prop_ro("other", [](const DatedSurfaceEvent& dated) { return dated.event.other; })
      .def_prop_ro("probability", [](const DatedSurfaceEvent& dated) { return dated.event.probability; })
      .def_prop_ro("segments", [](const DatedSurfaceEvent& dated) { return dated.event.segments; })
      .def_ro("run", &DatedSurfaceEvent::run)
      .def_ro("t", &DatedSurfaceEvent::t);
}

}  // namespace

void bind_online(nb::module_& m) {
  nb::enum_<Stream>(m, "Stream", "Which stream a measurement came from.")
      .value("Command", Stream::Command)
      .value("Wheels", Stream::Wheels)
      .value("Pose", Stream::Pose)
      .value("Attitude", Stream::Attitude)
      .value("Force", Stream::Force)
      .value("Reading", Stream::Reading);
  bind_learner_settings(m);
  bind_recordings(m);
  bind_evidence(m);
  bind_learner_results(m);
  bind_events(m);
  bind_odometry(m);
  bind_surface_events(m);
  nb::class_<Learner>(m, "MotionLearner", "Learns a motion model from one measurement at a time.")
      .def(nb::init<const LearnerSettings&>(), "settings"_a)
      .def("start_run", locked(&MotionLearner::start_run))
      .def("end_run", locked(&MotionLearner::end_run))
      .def("push_command", locked([](MotionLearner& learner, double t, double v, double omega, double vy) {
             learner.push(CommandSample{{t, {.v = v, .vy = vy, .omega = omega}}});
           }),
           "t"_a, "v"_a, "omega"_a, "vy"_a)
      .def("push_wheels", locked([](MotionLearner& learner, double t, double v, double omega, double vy) {
             learner.push(WheelSample{{t, {.v = v, .vy = vy, .omega = omega}}});
           }),
           "t"_a, "v"_a, "omega"_a, "vy"_a)
      .def("push_pose",
           locked([](MotionLearner& learner, double t, double x, double y, double yaw, long frame, double std_xy,
                     double std_yaw, bool learned, std::size_t source, std::size_t fix) {
             learner.push(MeasuredPose{.t = t,
                                       .x = x,
                                       .y = y,
                                       .yaw = yaw,
                                       .frame = frame,
                                       .std = {std_xy, std_yaw},
                                       .source = source,
                                       .fix = pose_fix(fix),
                                       .learned = learned});
           }),
           "t"_a, "x"_a, "y"_a, "yaw"_a, "frame"_a, "std_xy"_a = 0.0, "std_yaw"_a = 0.0, "learned"_a = true,
           "source"_a = 0, "fix"_a = 0)
      .def("push_position",
           locked([](MotionLearner& learner, double t, double x, double y, long frame, double std_xy, bool learned,
                     std::size_t source, std::size_t fix) {
             learner.push(MeasuredPose{.t = t,
                                       .x = x,
                                       .y = y,
                                       .yaw = 0.0,
                                       .frame = frame,
                                       .std = {.xy = std_xy},
                                       .source = source,
                                       .fix = pose_fix(fix),
                                       .position = true,
                                       .learned = learned});
           }),
           "t"_a, "x"_a, "y"_a, "frame"_a, "std_xy"_a = 0.0, "learned"_a = true, "source"_a = 0, "fix"_a = 0,
           "A position without a heading, which is taken from the course of its path.")
      .def("push_reading", locked([](MotionLearner& learner, double t, std::string_view column, double value) {
             learner.push(Reading{.kind = reading_kind(column), .t = t, .value = value});
           }),
           "t"_a, "column"_a, "value"_a, "A number of a sensor of `READINGS`.")
      .def_prop_ro("gyro_bias", locked([](const MotionLearner& learner) {
                     const GyroBuffer& gyro = learner.stream().drive().readings.gyro();
                     return std::array{gyro.bias(), gyro.bias_std()};
                   }),
                   "Of the gyro [rad/s], and its standard deviation.")
      .def_prop_ro("sources", locked([](const MotionLearner& learner) {
                     return learned_sources(learner.learned().sources(),
                                            learner.learned().known().newest().slip->noise_scale);
                   }),
                   "Estimates of each pose source, where there are several.")
      .def("push_attitude", locked([](MotionLearner& learner, double t, double roll, double pitch) {
             learner.push(Tilt{t, roll, pitch});
           }),
           "t"_a, "roll"_a, "pitch"_a)
      .def("push_force",
           locked([](MotionLearner& learner, double t, double x, double y) { learner.push(KnownForce{t, x, y}); }),
           "t"_a, "x"_a, "y"_a, "A known force over the mass [m/s^2], which holds until the next one.")
      .def_prop_ro("attitude_mounting",
                   locked([](const MotionLearner& learner) { return learner.stream().attitudes().mounting(); }),
                   "How the sensor of roll and pitch sits on the robot.")
      .def("push", locked([](MotionLearner& learner, const Recording& run) {
             const nb::gil_scoped_release released;
             push(learner, run);
           }),
           "run"_a, "Pushes recorded streams in the order of their stamps.")
      .def("events", locked(&MotionLearner::events), "What happened since the last call.")
      .def_prop_ro("dropped_events", locked(&MotionLearner::dropped_events))
      .def("predict",
           locked([](MotionLearner& learner, const Rows& future, double horizon, double embargo, const Rows& forces,
                     const ActuatorLimits* limits) {
             return learner.predict(samples(future, "future inputs"), horizon, embargo,
                                    {.forces = known_forces(forces), .limits = limits});
           }),
           "future"_a, "horizon"_a, "embargo"_a, "forces"_a, "limits"_a.none())
      .def("odometry", locked(&MotionLearner::odometry),
           "Where the robot is at the newest measurement; None before the first pose of the run.")
      .def("motion_monitor", locked(&MotionLearner::motion_monitor),
           "Whether the robot moves as its inputs and the learned model say it must.")
      .def("model", locked(&MotionLearner::model), "What was learned of all that was pushed.")
      .def("find_limits", locked([](const MotionLearner& learner, double wheel_separation) {
             const nb::gil_scoped_release released;
             return learner.find_limits(wheel_separation);
           }),
           "wheel_separation"_a,
           "Looks for limits of the actuator; None where there are too few wheel speeds beside commands.")
      .def("forget", locked(&MotionLearner::forget), "fraction"_a)
      .def("start_drive", locked([](MotionLearner& learner, const std::string& label, const std::string& date) {
             learner.start_drive({.label = label, .date = date});
           }),
           "label"_a = "", "date"_a = "", "Another drive begins, on a surface that is remembered or a new one.")
      .def("cue_terrain", locked(&MotionLearner::cue_terrain), "answer"_a, "A sensor says what the terrain is now.")
      .def("cue_surface", locked(&MotionLearner::cue_surface), "label"_a = "",
           "The surface changes now: to the one of this name, or to another where it is empty.")
      .def("completed", locked(&MotionLearner::completed), "A copy whose run has ended.")
      .def("probable_surfaces",
           locked([](const MotionLearner& learner) { return learner.learned().hypotheses().bank().probabilities(); }),
           "How probable each surface is to be the one under the robot; empty if none are remembered.")
      .def("surfaces", locked(&MotionLearner::surfaces), "The surfaces that are remembered, as they are known now.")
      .def("on_surface", locked([](const MotionLearner& learner, const Surface& surface, std::size_t structure) {
             return slip_on(learner.learned().hypotheses().structures(), surface, structure_of(structure));
           }),
           "surface"_a, "structure"_a, "Slip on one of them in the terms of a structure; None where it has no memory.")
      .def("slip_now", locked([](const MotionLearner& learner, std::size_t structure) {
             return slip_now(learner.learned().hypotheses().structures(), structure_of(structure));
           }),
           "structure"_a, "The same of the surface that is driven on, whether surfaces are remembered or not.")
      .def("begin_with", locked(&MotionLearner::begin_with), "known"_a, "law"_a, "wheels"_a,
           "Begins with what another learner knew, before anything was learned.")
      .def("add_surfaces", locked(&MotionLearner::add_surfaces), "other"_a,
           "Takes in the surfaces of another learner of the same robot; returns their names here.")
      .def("surface_events", locked(&MotionLearner::surface_events), "What happened to them since the last call.")
      .def("save", locked([](const MotionLearner& learner) { return bytes_of(learner.save()); }), "All of it as bytes.")
      .def_static(
          "load", [](const nb::bytes& saved) { return Learner(MotionLearner::load(view_of(saved))); }, "saved"_a,
          "The learner whose bytes these are.")
      .def_prop_ro("settings", locked([](const MotionLearner& learner) { return learner.learned().settings(); }))
      .def_prop_ro("compared",
                   locked([](const MotionLearner& learner) { return learner.stream().evidence().compared(); }),
                   "How much of the driving was looked at for contradictions; it grows while inputs drive the robot.")
      .def_prop_ro("newest", locked(&MotionLearner::newest));
}

}  // namespace slipwise::bindings
