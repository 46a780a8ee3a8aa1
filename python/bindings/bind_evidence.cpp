// SPDX-License-Identifier: Apache-2.0
// Bindings of what shows whether poses and inputs contradict each other.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/vector.h>

#include <deque>
#include <functional>
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

/// What both kinds of evidence tell in rows.
template <class Evidence>
void define_rows(nb::class_<Evidence>& evidence) {
  evidence
      .def_prop_ro(
          "windows", [](const Evidence& e) { return window_rows(std::invoke(&Evidence::windows, e)); },
          "Rows of (run, start, since, duration, distance, course, turn, turn_degrees, start_yaw), then (forward, "
          "sideways, rotation, known) of the commands and the same of the wheels, of poses that the gate accepted.")
      .def_prop_ro(
          "measured_windows",
          [](const Evidence& e) { return window_rows(std::invoke(&Evidence::measured_windows, e)); },
          "The same of poses as they were measured.")
      .def(
          "probed_motions",
          [](const Evidence& e, double offset) {
            return motion_rows(probed_motions(std::invoke(&Evidence::probes, e), offset));
          },
          "offset"_a,
          "Pairs of poses a second apart: rows of (x, y, turn) of the second seen from the first, then the same by the "
          "wheels' path where their clock is `offset` [s] behind.")
      .def_prop_ro(
          "gyro_turns", [](const Evidence& e) { return turn_rows(std::invoke(&Evidence::gyro_turns, e)); },
          "Rows of (run, seconds, sum of products of turns by inputs and gyro, sum of squares by inputs).");
}

}  // namespace

void bind_evidence(nb::module_& m) {
  nb::class_<GateCounts>(m, "GateCounts", "Poses that the gate accepted, and those that it did not.")
      .def_ro("accepted", &GateCounts::accepted)
      .def_ro("outliers", &GateCounts::outliers)
      .def_ro("jumps", &GateCounts::jumps);
  nb::class_<RecentEvidence> recent(m, "RecentEvidence",
                                    "What poses and inputs did in the last two minutes of driving.");
  recent.def_ro("counts", &RecentEvidence::counts);
  define_rows(recent);
  nb::class_<MotionEvidence> all(m, "MotionEvidence", "What shows whether poses and inputs contradict each other.");
  all.def_prop_ro("counts", &MotionEvidence::counts)
      .def_prop_ro("recent", &MotionEvidence::recent, "None where all that was driven is recent.");
  define_rows(all);
  m.def(
      "motion_evidence",
      [](const StreamSettings& settings, const std::vector<Recording>& runs) {
        return motion_evidence(settings, runs);
      },
      "settings"_a, "runs"_a, "What a learner with these settings knows of contradictions after recorded runs.");
}

}  // namespace slipwise::bindings
