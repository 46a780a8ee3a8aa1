// SPDX-License-Identifier: Apache-2.0
// Bindings of what goes into a learner and judges it: sources of poses, recorded runs, evidence of contradictions.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "pose_sources.hpp"
#include "sample_rows.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/known_sources.hpp"
#include "slipwise/online/motion_evidence.hpp"
#include "slipwise/online/probed_motion.hpp"
#include "slipwise/online/recording.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

Recording recording(const Rows& commands, const Rows& wheels, const Rows& attitudes, const Rows& poses,
                    const std::map<std::string, Rows>& measured, const std::optional<Rows>& forces) {
  check_columns(attitudes, 3, "attitudes");
  const bool with_source = poses.cols() == 9;
  const bool with_std = poses.cols() != 5;
  check_columns(poses, with_source ? 9 : (with_std ? 7 : 5), "poses");
  Recording run{
      .commands = samples(commands, "commands"), .wheels = samples(wheels, "wheels"), .attitudes = {}, .poses = {}};
  for (const auto& row : attitudes.rowwise()) {
    run.attitudes.push_back({row[0], row[1], row[2]});
  }
  if (with_source && !(poses.middleCols(7, 2).array() >= 0.0).all()) {
    throw std::invalid_argument("numbers of sources and fixes must be 0 or more");
  }
  for (const auto& row : poses.rowwise()) {
    run.poses.push_back({.t = row[0],
                         .x = row[1],
                         .y = row[2],
                         .yaw = std::isnan(row[3]) ? 0.0 : row[3],
                         .frame = static_cast<long>(row[4]),
                         .std = with_std ? PoseStd{.xy = row[5], .yaw = row[6]} : PoseStd{},
                         .source = with_source ? static_cast<std::size_t>(row[7]) : 0,
                         .fix = with_source ? pose_fix(static_cast<std::size_t>(row[8])) : PoseFix::Unknown,
                         .position = std::isnan(row[3])});
  }
  run.readings = readings(measured);
  if (forces) {
    run.forces = known_forces(*forces);
  }
  return run;
}

Rows pose_rows(const std::vector<MeasuredPose>& poses) {
  Rows rows(std::ssize(poses), 5);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const MeasuredPose& pose = poses[static_cast<std::size_t>(i)];
    rows.row(i) << pose.t, pose.x, pose.y, pose.yaw, static_cast<double>(pose.frame);
  }
  return rows;
}

void bind_attitudes(nb::module_& m) {
  nb::enum_<AttitudeMounting::Kind>(m, "MountingKind", "How a sensor sits on its robot.")
      .value("Level", AttitudeMounting::Kind::Level)
      .value("Rolled", AttitudeMounting::Kind::Rolled, "By quarters of a turn about its forward axis, which is undone.")
      .value("Other", AttitudeMounting::Kind::Other, "What it says of tilt is not used.");
  nb::class_<AttitudeMounting>(m, "AttitudeMounting", "How the sensor of roll and pitch sits on the robot.")
      .def_ro("kind", &AttitudeMounting::kind)
      .def_ro("roll", &AttitudeMounting::roll, "On level ground [rad].")
      .def_ro("pitch", &AttitudeMounting::pitch, "On level ground [rad].");
  nb::class_<AttitudeGate>(m, "AttitudeGate", "What attitudes of a sensor say of the robot.")
      .def(nb::init<>())
      .def(
          "level",
          [](AttitudeGate& gate, double t, double roll, double pitch) -> std::optional<std::array<double, 2>> {
            const auto tilt = gate.level({t, roll, pitch});
            return tilt ? std::optional(std::array{tilt->roll, tilt->pitch}) : std::nullopt;
          },
          "t"_a, "roll"_a, "pitch"_a,
          "Roll and pitch of the robot [rad]; None where no robot drives like that, or the mounting is not known.")
      .def_prop_ro("mounting", &AttitudeGate::mounting);
}

void bind_readings(nb::module_& m) {
  nb::class_<ReadingKind>(m, "ReadingKind", "A kind of sensor that measures one number.")
      .def_ro("column", &ReadingKind::column, "Of a tidy log.")
      .def_ro("sensor", &ReadingKind::sensor, "In a word.")
      .def_ro("unit", &ReadingKind::unit)
      .def_ro("meaning", &ReadingKind::meaning);
  m.def(
      "reading_kinds", [] { return std::vector(kReadings.begin(), kReadings.end()); },
      "Sensors that measure one number, in the order in which they count at one stamp.");
}

Rows window_rows(const std::deque<MotionWindow>& windows) {
  Rows rows(std::ssize(windows), 19);
  Eigen::Index i = 0;
  for (const MotionWindow& w : windows) {
    rows.row(i++) << static_cast<double>(w.run), w.start, w.since, w.duration, w.distance, w.course, w.turn,
        w.turn_degrees, w.start_yaw, w.commands.forward, w.commands.sideways, w.commands.rotation, w.commands.known,
        w.wheels.forward, w.wheels.sideways, w.wheels.rotation, w.wheels.known, w.ahead, w.left;
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
          "sideways, rotation, known) of the commands and the same of the wheels, then the ways ahead and left along "
          "the measured heading, of poses that the gate accepted.")
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

PoseFix pose_fix(std::size_t number) {
  if (number >= kPoseFixes) {
    throw std::invalid_argument("a fix is a number below " + std::to_string(kPoseFixes) + ", got " +
                                std::to_string(number));
  }
  return static_cast<PoseFix>(number);
}

std::vector<LearnedSource> learned_sources(const KnownSources& sources, const Eigen::Vector3d& scale) {
  std::vector<LearnedSource> found;
  for (std::size_t i = 0; i < sources.calibrations().size(); ++i) {
    LearnedSource source{.calibration = sources.calibrations()[i].estimate(),
                         .segments = sources.learned()[i],
                         .noise = Eigen::Matrix<double, Eigen::Dynamic, 3>(kPoseFixes, 3),
                         .seen = std::vector<bool>(kPoseFixes)};
    for (std::size_t fix = 0; fix < kPoseFixes; ++fix) {
      const std::size_t each = noise_class(i, static_cast<PoseFix>(fix));
      source.seen[fix] = sources.noise().met(each);
      source.noise.row(static_cast<Eigen::Index>(fix)) =
          sources.noise().size({each, each}, scale).cwiseQuotient(scale).cwiseSqrt();
    }
    found.push_back(std::move(source));
  }
  return found;
}

void bind_sources(nb::module_& m) {
  nb::class_<SourceSettings>(m, "SourceSettings", "Settings of a pose source before it measures.")
      .def(nb::init<>())
      .def_rw("sensor", &SourceSettings::sensor)
      .def_rw("late", &SourceSettings::late)
      .def_rw("clock_std", &SourceSettings::clock_std)
      .def_rw("sensor_std_xy", &SourceSettings::sensor_std_xy)
      .def_rw("sensor_std_yaw", &SourceSettings::sensor_std_yaw)
      .def_rw("poorest", &SourceSettings::poorest);
  nb::class_<LearnedSource>(m, "LearnedSource", "Estimates of a pose source.")
      .def_ro("calibration", &LearnedSource::calibration, "Lateness [s], x, y [m] and yaw [rad] in base_link.")
      .def_ro("segments", &LearnedSource::segments, "Segments learned between its poses.")
      .def_ro("seen", &LearnedSource::seen, "Of each fix, whether there was a segment; [fixes].")
      .def_ro("noise", &LearnedSource::noise,
              "Of each fix, factors of the standard deviations (x, y, theta) beside the first; [fixes, 3].");
  m.def(
      "fix_names",
      [] {
        std::vector<std::string_view> names;
        for (std::size_t i = 0; i < kPoseFixes; ++i) {
          names.push_back(fix_name(static_cast<PoseFix>(i)));
        }
        return names;
      },
      "Fixes of a satellite receiver by number, in the order in which they become better.");
}

void bind_recordings(nb::module_& m) {
  m.attr("SAME_STAMP") = kSameStamp;  // [s] stamps no further apart are the same
  bind_attitudes(m);
  bind_readings(m);
  nb::class_<Recording>(m, "Recording", "One recorded run, each stream in the order of its stamps.")
      .def(
          "__init__",
          [](Recording* self, const Rows& commands, const Rows& wheels, const Rows& attitudes, const Rows& poses,
             const std::map<std::string, Rows>& readings, const std::optional<Rows>& forces) {
            new (self) Recording(recording(commands, wheels, attitudes, poses, readings, forces));
          },
          "commands"_a, "wheels"_a, "attitudes"_a, "poses"_a, "readings"_a = nb::dict(), "forces"_a = nb::none(),
          "Rows of (t, v, vy, omega) [s, m/s, m/s, rad/s], the same of the wheels, (t, roll, pitch) [s, rad, rad] and "
          "(t, x, y, yaw, frame, std_xy, std_yaw) [s, m, m, rad, -, m, rad], of which the last two are 0 where "
          "unknown, or both left away; then the numbers of the source and of the fix may follow. A yaw of NaN says "
          "that "
          "only the position was measured. Of sensors of one number rows of (t, number) by the columns of "
          "`reading_kinds`; of known forces over the mass "
          "rows of (t, x, y) [s, m/s^2, m/s^2], each of which holds until the next one.");
  nb::class_<Rejected>(m, "Rejected", "Something rejected.")
      .def_ro("stream", &Rejected::stream)
      .def_ro("t", &Rejected::t)
      .def_prop_ro("reason", [](const Rejected& rejected) { return reason_name(rejected.reason); })
      .def_prop_ro("reason_text", [](const Rejected& rejected) { return reason_text(rejected.reason); });
  nb::class_<DrivenSegment>(m, "DrivenSegment", "A segment together with the inputs that drove it.")
      .def_ro("inputs", &DrivenSegment::inputs)
      .def_ro("segment", &DrivenSegment::segment)
      .def_ro("known_at", &DrivenSegment::known_at);
  nb::class_<CutRuns>(m, "CutRuns", "Recorded runs as segments.")
      .def_ro("segments", &CutRuns::segments)
      .def_ro("run", &CutRuns::run)
      .def_ro("rejected", &CutRuns::rejected)
      .def_ro("rejected_run", &CutRuns::rejected_run);
  m.def(
      "cut_segments",
      [](const StreamSettings& settings, const std::vector<Recording>& runs) { return cut_segments(settings, runs); },
      "settings"_a, "runs"_a, "The segments that a learner with these settings learns.");
  m.def(
      "expected_commands",
      [](const StreamSettings& settings, const std::vector<Recording>& runs) {
        std::vector<Rows> all;
        for (const auto& run : expected_commands(settings, runs)) {
          Rows rows(std::ssize(run), 4);
          for (Eigen::Index i = 0; i < rows.rows(); ++i) {
            const InputSample& sample = run[static_cast<std::size_t>(i)];
            rows.row(i) << sample.t, sample.twist.v, sample.twist.vy, sample.twist.omega;
          }
          all.push_back(std::move(rows));
        }
        return all;
      },
      "settings"_a, "runs"_a,
      "About what a car makes of each command: rows of (t, v, vy, omega), a table for each run.");
  nb::class_<GatedPoses>(m, "GatedPoses", "What the gate makes of the poses; rows of (t, x, y, yaw, frame).")
      .def_prop_ro("accepted", [](const GatedPoses& gated) { return pose_rows(gated.accepted); })
      .def_prop_ro("outliers", [](const GatedPoses& gated) { return pose_rows(gated.outliers); })
      .def_prop_ro("jumps", [](const GatedPoses& gated) { return pose_rows(gated.jumps); });
  m.def("gate_poses", &gate_poses, "run"_a, "unknown_after"_a,
        "The poses of a recorded run as a learner uses them: outliers rejected, frames numbered again at jumps.");
}

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
