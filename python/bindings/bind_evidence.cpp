// SPDX-License-Identifier: Apache-2.0
// Bindings of what shows whether poses and inputs contradict each other.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/vector.h>

#include <deque>
#include <vector>

#include "bindings.hpp"
#include "sample_rows.hpp"
#include "slipwise/online/motion_evidence.hpp"
#include "slipwise/online/probed_motion.hpp"
#include "slipwise/online/recording.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

Rows window_rows(const std::deque<MotionWindow>& windows) {
  Rows rows(std::ssize(windows), 17);
  Eigen::Index i = 0;
  for (const MotionWindow& w : windows) {
    rows.row(i++) << static_cast<double>(w.run), w.start, w.since, w.duration, w.distance, w.course, w.turn,
        w.turn_degrees, w.start_yaw, w.commands.forward, w.commands.sideways, w.commands.rotation, w.commands.known,
        w.wheels.forward, w.wheels.sideways, w.wheels.rotation, w.wheels.known;
  }
  return rows;
}

Rows motion_rows(const std::vector<ProbedMotion>& motions) {
  Rows rows(std::ssize(motions), 6);
  Eigen::Index i = 0;
  for (const ProbedMotion& motion : motions) {
    rows.row(i++) << motion.measured.vector().transpose(), motion.rolled.vector().transpose();
  }
  return rows;
}

Rows turn_rows(const std::deque<GyroTurns>& turns) {
  Rows rows(std::ssize(turns), 4);
  Eigen::Index i = 0;
  for (const GyroTurns& each : turns) {
    rows.row(i++) << static_cast<double>(each.run), static_cast<double>(each.count), each.product, each.square;
  }
  return rows;
}

}  // namespace

void bind_evidence(nb::module_& m) {
  nb::class_<GateCounts>(m, "GateCounts", "Poses that the gate accepted, and those that it did not.")
      .def_ro("accepted", &GateCounts::accepted)
      .def_ro("outliers", &GateCounts::outliers)
      .def_ro("jumps", &GateCounts::jumps);
  nb::class_<MotionEvidence>(m, "MotionEvidence", "What shows whether poses and inputs contradict each other.")
      .def_prop_ro(
          "windows", [](const MotionEvidence& evidence) { return window_rows(evidence.windows()); },
          "Rows of (run, start, since, duration, distance, course, turn, turn_degrees, start_yaw), then (forward, "
          "sideways, rotation, known) of the commands and the same of the wheels, of poses that the gate accepted.")
      .def_prop_ro(
          "measured_windows", [](const MotionEvidence& evidence) { return window_rows(evidence.measured_windows()); },
          "The same of poses as they were measured.")
      .def(
          "probed_motions",
          [](const MotionEvidence& evidence, double offset) {
            return motion_rows(probed_motions(evidence.probes(), offset));
          },
          "offset"_a,
          "Pairs of poses a second apart, spread over all that was driven: rows of (x, y, turn) of the second seen "
          "from the first, then the same by the wheels' path where their clock is `offset` [s] behind.")
      .def_prop_ro(
          "gyro_turns", [](const MotionEvidence& evidence) { return turn_rows(evidence.gyro_turns()); },
          "Rows of (run, seconds, sum of products of turns by inputs and gyro, sum of squares by inputs).")
      .def_prop_ro("counts", &MotionEvidence::counts);
  m.def(
      "motion_evidence",
      [](const StreamSettings& settings, const std::vector<Recording>& runs) {
        return motion_evidence(settings, runs);
      },
      "settings"_a, "runs"_a, "What a learner with these settings knows of contradictions after recorded runs.");
}

}  // namespace slipwise::bindings
