// SPDX-License-Identifier: Apache-2.0
// Bindings of recorded runs: handed to a learner whole, cut into segments, and as the gates see them.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "bindings.hpp"
#include "pose_sources.hpp"
#include "sample_rows.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/recording.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

Recording recording(const Rows& commands, const Rows& wheels, const Rows& attitudes, const Rows& poses,
                    const std::optional<Rows>& gyro, const std::optional<Rows>& forces) {
  check_columns(attitudes, 3, "attitudes");
  const bool with_source = poses.cols() == 9;
  const bool with_std = poses.cols() != 5;
  check_columns(poses, with_source ? 9 : (with_std ? 7 : 5), "poses");
  Recording run{
      .commands = samples(commands, "commands"), .wheels = samples(wheels, "wheels"), .attitudes = {}, .poses = {}};
  for (const auto& row : attitudes.rowwise()) {
    run.attitudes.push_back({row[0], row[1], row[2]});
  }
  if (with_source && !(poses.middleCols(7, 2).minCoeff() >= 0.0)) {
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
  if (gyro) {
    check_columns(*gyro, 2, "gyro");
    for (const auto& row : gyro->rowwise()) {
      run.gyro.push_back({row[0], row[1]});
    }
  }
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

}  // namespace

void bind_recordings(nb::module_& m) {
  m.attr("SAME_STAMP") = kSameStamp;  // [s] stamps no further apart are the same
  bind_attitudes(m);
  nb::class_<Recording>(m, "Recording", "One recorded run, each stream in the order of its stamps.")
      .def(
          "__init__",
          [](Recording* self, const Rows& commands, const Rows& wheels, const Rows& attitudes, const Rows& poses,
             const std::optional<Rows>& gyro, const std::optional<Rows>& forces) {
            new (self) Recording(recording(commands, wheels, attitudes, poses, gyro, forces));
          },
          "commands"_a, "wheels"_a, "attitudes"_a, "poses"_a, "gyro"_a = nb::none(), "forces"_a = nb::none(),
          "Rows of (t, v, vy, omega) [s, m/s, m/s, rad/s], the same of the wheels, (t, roll, pitch) [s, rad, rad] and "
          "(t, x, y, yaw, frame, std_xy, std_yaw) [s, m, m, rad, -, m, rad], of which the last two are 0 where "
          "unknown, or both left away; then the numbers of the source and of the fix may follow. A yaw of NaN says "
          "that "
          "only the position was measured. Of a gyro rows of (t, yaw rate) [s, rad/s]; of known forces over the mass "
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

}  // namespace slipwise::bindings
