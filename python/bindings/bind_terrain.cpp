// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/terrain.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "checked_shapes.hpp"
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

}  // namespace slipwise::bindings
