// SPDX-License-Identifier: Apache-2.0
// Bindings of surfaces, of what sensors say of the terrain, and of the envelope of saved states.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "checked_shapes.hpp"
#include "slipwise/archive/bytes.hpp"
#include "slipwise/hypotheses/motion_hypotheses.hpp"
#include "slipwise/hypotheses/surface_probability.hpp"
#include "slipwise/terrain/terrain_watch.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

void bind_features(nb::module_& m) {
  nb::class_<VibrationBands>(m, "VibrationBands", "Bands of frequency at one sampling rate [Hz].")
      .def(nb::init<double>(), "rate"_a)
      .def_prop_ro("edges", &VibrationBands::edges, "Lower and upper edge of each band [Hz].")
      .def("features", &VibrationBands::features, "samples"_a,
           "Log power of each axis in each band, axis by axis, of samples [n, 6].");
  m.def("current_features", &current_features, "samples"_a,
        "Describes left and right current [A] and wheel speed [m/s], [n, 4], by 16 numbers.");
  m.def("even_samples", &even_samples, "times"_a, "values"_a, "start"_a, "seconds_and_rate"_a,
        "A stream at evenly spaced times, [n, D]; None where samples are missing.");
  m.def("squared_distances", &squared_distances, "first"_a, "second"_a, "Squared distances between rows.");
}

void bind_experts(nb::module_& m) {
  nb::class_<KernelExpert>(m, "KernelExpert", "Tells surfaces apart by vibration.")
      .def(nb::init<Eigen::VectorXd, Eigen::VectorXd, double, Eigen::MatrixXd, Eigen::MatrixXd>(), "mean"_a, "scale"_a,
           "width"_a, "centres"_a, "weights"_a)
      .def("probabilities", &KernelExpert::probabilities, "features"_a, "Of each surface, [M, K]; not calibrated.")
      .def("newness", &KernelExpert::newness, "features"_a, "Log of the distance to the nearest windows, [M].");
  nb::class_<TerrainTree>(m, "TerrainTree", "A binary tree; node 0 is the root.")
      .def(
          "__init__",
          [](TerrainTree* self, const std::vector<int>& feature, const std::vector<double>& threshold,
             const std::vector<int>& left, const std::vector<int>& right,
             const Eigen::MatrixXd& leaves) { new (self) TerrainTree{feature, threshold, left, right, leaves}; },
          "feature"_a, "threshold"_a, "left"_a, "right"_a, "leaves"_a);
  nb::class_<TreeExpert>(m, "TreeExpert", "Tells surfaces apart by motor currents.")
      .def(nb::init<std::vector<TerrainTree>, Eigen::Index>(), "trees"_a, "features"_a)
      .def("probabilities", &TreeExpert::probabilities, "features"_a, "Of each surface, [M, K]; not calibrated.");
  nb::class_<ExpertPool>(m, "ExpertPool", "Pools the experts, and judges what is unknown.")
      .def(
          "__init__",
          [](ExpertPool* self, double vibration, double current, double offset, double doubt, double newness) {
            new (self) ExpertPool{vibration, current, offset, doubt, newness};
          },
          "vibration"_a, "current"_a, "offset"_a, "doubt"_a, "newness"_a)
      .def("pooled", &ExpertPool::pooled, "by_vibration"_a, "by_current"_a, "The pooled probabilities [N, K].")
      .def("unknown", &ExpertPool::unknown, "probability"_a, "newness_of"_a, "P(unknown) [N].");
  m.def("doubt_of", &doubt_of, "probability"_a, "Log odds against the most probable surface, [N].");
}

}  // namespace

void bind_surfaces(nb::module_& m) {
  nb::class_<SurfaceSettings>(m, "SurfaceSettings", "How surfaces are remembered and recalled.")
      .def(nb::init<>())
      .def_rw("remember", &SurfaceSettings::remember)
      .def_rw("false_alarm", &SurfaceSettings::false_alarm)
      .def_rw("doubt", &SurfaceSettings::doubt)
      .def_rw("drift", &SurfaceSettings::drift)
      .def_rw("soonest", &SurfaceSettings::soonest)
      .def_rw("learning_rate", &SurfaceSettings::learning_rate)
      .def_rw("trial", &SurfaceSettings::trial)
      .def_rw("fewest", &SurfaceSettings::fewest)
      .def_rw("changed", &SurfaceSettings::changed)
      .def_rw("unknown", &SurfaceSettings::unknown)
      .def_rw("merge", &SurfaceSettings::merge)
      .def_rw("alike", &SurfaceSettings::alike)
      .def_rw("most", &SurfaceSettings::most);
  nb::class_<SurfaceSlip>(m, "SurfaceSlip", "Slip of a surface under one basis, given the robot.")
      .def(
          "__init__",
          [](SurfaceSlip* self, const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance,
             const Eigen::MatrixXd& by_robot, const Eigen::VectorXd& robot, const std::array<double, 2>& speeds,
             const Eigen::Vector3d& noise_scale) {
            check_square(covariance, mean.size(), "the covariance of slip");
            check_columns(by_robot, robot.size(), "slip by the robot");
            if (by_robot.rows() != mean.size()) {
              throw std::invalid_argument("slip by the robot needs one row per term");
            }
            new (self) SurfaceSlip{.mean = mean,
                                   .covariance = covariance,
                                   .by_robot = by_robot,
                                   .robot = robot,
                                   .prior_std = Eigen::VectorXd::Ones(mean.size()),
                                   .speeds = {.v = speeds[0], .omega = speeds[1]},
                                   .noise_scale = NoiseScale({}, noise_scale)};
          },
          "mean"_a, "covariance"_a, "by_robot"_a, "robot"_a, "speeds"_a, "noise_scale"_a)
      .def_ro("mean", &SurfaceSlip::mean)
      .def_ro("covariance", &SurfaceSlip::covariance)
      .def_ro("by_robot", &SurfaceSlip::by_robot)
      .def_ro("robot", &SurfaceSlip::robot)
      .def_prop_ro("noise_scale", [](const SurfaceSlip& slip) { return slip.noise_scale.value(); });
  m.def(
      "shrunk_prior",
      [](const std::vector<SurfaceSlip>& known, const Eigen::VectorXd& first_std, const std::array<double, 2>& speeds) {
        for (const SurfaceSlip& each : known) {
          if (each.mean.size() != first_std.size() || each.robot.size() != 0) {
            throw std::invalid_argument("surfaces have slip in the terms of the prior, and here no robot beside it");
          }
        }
        return shrunk_prior(known, Eigen::VectorXd(0), first_std, {.v = speeds[0], .omega = speeds[1]});
      },
      "known"_a, "first_std"_a, "speeds"_a,
      "The prior of a surface that was never driven, from those that were and the prior of a first drive.");
  nb::class_<Surface>(m, "Surface", "A surface that is remembered.")
      .def(nb::init<>())
      .def_ro("name", &Surface::name)
      .def_ro("seconds", &Surface::seconds)
      .def_ro("segments", &Surface::segments)
      .def_ro("visits", &Surface::visits)
      .def_ro("last_seen", &Surface::last_seen)
      .def_ro("classes", &Surface::classes, "Classes of terrain that sensors named on it, in visits.")
      .def_prop_ro("speeds", [](const Surface& surface) {
        return std::array<double, 2>{surface.speeds.v, surface.speeds.omega};
      });
  nb::class_<NamedMemory>(m, "SurfaceMemory", "What is remembered of a surface, per basis.")
      .def(
          "__init__",
          [](NamedMemory* self, const std::vector<std::string>& bases, const std::vector<SurfaceSlip>& slips,
             const Eigen::VectorXd& weights, std::size_t observed) {
            check_size(weights, std::ssize(slips), "the weights of bases");
            if (bases.size() != slips.size()) {
              throw std::invalid_argument("a memory needs one name per basis");
            }
            new (self) NamedMemory{bases, {.slips = slips, .weights = weights, .observed = observed}};
          },
          "bases"_a, "slips"_a, "weights"_a, "observed"_a)
      .def_ro("bases", &NamedMemory::bases)
      .def_prop_ro("slips", [](const NamedMemory& memory) { return memory.memory.slips; })
      .def_prop_ro("weights", [](const NamedMemory& memory) { return memory.memory.weights; })
      .def_prop_ro("observed", [](const NamedMemory& memory) { return memory.memory.observed; });
  nb::class_<SlipOnSurface>(m, "SlipOnSurface", "Slip of a surface in the terms of one structure.")
      .def_ro("state", &SlipOnSurface::state)
      .def_ro("memory", &SlipOnSurface::memory)
      .def_prop_ro("prior_speeds", [](const SlipOnSurface& slip) {
        return std::array<double, 2>{slip.prior_speeds.v, slip.prior_speeds.omega};
      });
  nb::class_<KnownSurface>(m, "KnownSurface", "A surface that another learner knew.")
      .def(
          "__init__",
          [](KnownSurface* self, const std::string& name, const std::array<double, 3>& seconds_and_speeds,
             const std::array<std::size_t, 2>& segments_and_visits, const std::string& last_seen,
             const NamedMemory& memory, const ClassCounts& classes) {
            const auto& [seconds, v, omega] = seconds_and_speeds;
            new (self) KnownSurface{.facts = {.name = name,
                                              .seconds = seconds,
                                              .segments = segments_and_visits[0],
                                              .visits = segments_and_visits[1],
                                              .last_seen = last_seen,
                                              .speeds = {.v = v, .omega = omega},
                                              .classes = classes},
                                    .memory = memory};
          },
          "name"_a, "seconds_and_speeds"_a, "segments_and_visits"_a, "last_seen"_a, "memory"_a, "classes"_a,
          "Seconds driven, and the speed [m/s] and yaw rate [rad/s] covered; segments learned and visits; classes of "
          "terrain that sensors named on it, in visits.");
  nb::class_<KnownBefore>(m, "KnownBefore", "What a learner begins with.")
      .def(
          "__init__",
          [](KnownBefore* self, const MotionPosterior& model, std::size_t structure,
             const std::vector<KnownSurface>& surfaces, const std::array<double, 2>& labels) {
            new (self) KnownBefore{model, surfaces, {.all = labels[0], .right = labels[1]}};
            self->model.structure = structure_of(structure);
          },
          "model"_a, "structure"_a, "surfaces"_a, "labels"_a, "Labels: how many there were, and how many were right.");
  nb::class_<SurfaceBank>(m, "SurfaceBank", "The surfaces that are remembered.")
      .def_prop_ro("surfaces", [](const SurfaceBank& bank) { return bank.surfaces(); })
      .def_prop_ro("present", &SurfaceBank::present)
      .def_prop_ro("label_reliability", [](const SurfaceBank& bank) { return bank.labels().reliability(); })
      .def_prop_ro("labels", [](const SurfaceBank& bank) {
        return std::array<double, 2>{bank.labels().all, bank.labels().right};
      });
  m.def(
      "surfaces_of_class",
      [](const std::string& name, const std::vector<std::pair<std::string, ClassCounts>>& surfaces) {
        std::vector<NamedClasses> named;
        for (const auto& [surface, classes] : surfaces) {
          named.push_back({surface, classes});
        }
        return surfaces_of_class(name, named);
      },
      "name"_a, "surfaces"_a,
      "P(surface | class) of each surface, a name and its classes in visits, and last of a new one.");
  nb::enum_<SurfaceEvent::Kind>(m, "SurfaceEventKind", "What happened to a surface.")
      .value("Opened", SurfaceEvent::Kind::Opened)
      .value("Recalled", SurfaceEvent::Kind::Recalled)
      .value("Kept", SurfaceEvent::Kind::Kept)
      .value("Merged", SurfaceEvent::Kind::Merged)
      .value("Dropped", SurfaceEvent::Kind::Dropped);
  nb::class_<SurfaceProbability>(m, "SurfaceProbability", "How probable a surface is to be under the robot.")
      .def_ro("name", &SurfaceProbability::name, "Empty: one that has no name yet.")
      .def_ro("probability", &SurfaceProbability::probability);
}

void bind_terrain(nb::module_& m) {
  bind_features(m);
  bind_experts(m);
  nb::class_<TerrainAnswer>(m, "TerrainAnswer", "What some sensor says of the surface.")
      .def(
          "__init__",
          [](TerrainAnswer* self, const std::vector<std::string>& classes, const Eigen::VectorXd& probability,
             double unknown) {
            const TerrainAnswer answer{classes, probability, unknown};
            check_answer(answer);
            new (self) TerrainAnswer(answer);
          },
          "classes"_a, "probability"_a, "unknown"_a)
      .def_ro("classes", &TerrainAnswer::classes)
      .def_ro("probability", &TerrainAnswer::probability)
      .def_ro("unknown", &TerrainAnswer::unknown);
  nb::class_<TerrainAnswers>(m, "TerrainAnswers", "What windows say.")
      .def_prop_ro(
          "kind",
          [](const TerrainAnswers& answers) {
            std::vector<int> kinds;
            for (const WindowKind kind : answers.kind) {
              kinds.push_back(static_cast<int>(kind));
            }
            return kinds;
          },
          "What windows have: 0 nothing, 1 currents, 2 vibration, 3 both.")
      .def_ro("probability", &TerrainAnswers::probability)
      .def_ro("unknown", &TerrainAnswers::unknown);
  nb::class_<TerrainClassifier>(m, "TerrainClassifier", "Experts for vibration and currents, pooled.")
      .def(
          "__init__",
          [](TerrainClassifier* self, const std::vector<std::string>& surfaces,
             const std::optional<KernelExpert>& vibration, const std::optional<TreeExpert>& current,
             const std::array<std::optional<ExpertPool>, kWindowKinds>& pools) {
            new (self) TerrainClassifier({surfaces, vibration, current, pools});
          },
          "surfaces"_a, "vibration"_a.none(), "current"_a.none(), "pools"_a,
          "Pools of windows with nothing (None), currents, vibration, and both.")
      .def("answers", &TerrainClassifier::answers, "vibration"_a, "current"_a, "What windows say with what they have.");
  nb::class_<TimedAnswer>(m, "TimedTerrainAnswer", "What one window says.")
      .def_ro("start", &TimedAnswer::start)
      .def_ro("end", &TimedAnswer::end)
      .def_ro("answer", &TimedAnswer::answer);
  nb::class_<TerrainWatch>(m, "TerrainWatch", "Names the surface while a robot drives.")
      .def(
          "__init__",
          [](TerrainWatch* self, const TerrainClassifier& classifier, const std::array<double, 3>& seconds_and_rates,
             double step) {
            const auto& [seconds, imu, drive] = seconds_and_rates;
            new (self) TerrainWatch(classifier, {.seconds = seconds, .imu_rate = imu, .drive_rate = drive}, step);
          },
          "classifier"_a, "seconds_and_rates"_a, "step"_a,
          "Seconds of a window, the rates [Hz] of IMU and currents in training, and the time between windows [s].")
      .def("push_imu", &TerrainWatch::push_imu, "t"_a, "sample"_a)
      .def("push_drive", &TerrainWatch::push_drive, "t"_a, "sample"_a)
      .def("take_answers", &TerrainWatch::take_answers)
      .def_prop_ro("left_out", &TerrainWatch::left_out);
}

void bind_archive(nb::module_& m) {
  m.def(
      "sealed", [](const nb::bytes& body) { return bytes_of(archive::sealed(view_of(body))); }, "body"_a,
      "Bytes behind a header and before a checksum.");
  m.def(
      "opened", [](const nb::bytes& blob) { return bytes_of(archive::opened(view_of(blob))); }, "blob"_a,
      "The bytes that were sealed.");
}

}  // namespace slipwise::bindings
