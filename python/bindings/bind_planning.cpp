// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/planning.
#include <nanobind/eigen/dense.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string_view.h>

#include "bindings.hpp"
#include "slipwise/planning/distance_field.hpp"
#include "slipwise/planning/trajectory.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

Eigen::VectorXd vector_of(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

Eigen::MatrixX3d pose_matrix(const std::vector<Pose2>& poses) {
  Eigen::MatrixX3d matrix(static_cast<Eigen::Index>(poses.size()), 3);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    matrix.row(static_cast<Eigen::Index>(i)) = poses[i].vector();
  }
  return matrix;
}

void bind_settings(nb::module_& m) {
  nb::class_<DriveLimits>(m, "DriveLimits", "Limits of the commands [m/s, rad/s, 1/m, m/s^2].")
      .def(nb::init<double, double, double, double>(), "speed"_a, "yaw_rate"_a, "curvature"_a, "acceleration"_a)
      .def("check", &DriveLimits::check);
  nb::class_<DriveStart>(m, "DriveStart", "What the drive does and was told last when a plan begins.")
      .def(nb::init<BodyTwist, BodyTwist>(), "drive"_a, "told"_a);
  nb::class_<TrajectorySettings>(m, "TrajectorySettings", "How trajectories are shaped.")
      .def(nb::init<>())
      .def_rw("cruise", &TrajectorySettings::cruise)
      .def_rw("end_speed", &TrajectorySettings::end_speed)
      .def_rw("longest", &TrajectorySettings::longest)
      .def_rw("backwards", &TrajectorySettings::backwards)
      .def_rw("commands", &TrajectorySettings::commands)
      .def_rw("guesses", &TrajectorySettings::guesses)
      .def_rw("samples", &TrajectorySettings::samples)
      .def_prop_rw(
          "tolerance_xy", [](const TrajectorySettings& s) { return s.reach.tolerance_xy; },
          [](TrajectorySettings& s, double value) { s.reach.tolerance_xy = value; })
      .def_prop_rw(
          "tolerance_yaw", [](const TrajectorySettings& s) { return s.reach.tolerance_yaw; },
          [](TrajectorySettings& s, double value) { s.reach.tolerance_yaw = value; });
}

void bind_trajectory(nb::module_& m) {
  nb::enum_<TrajectoryStatus>(m, "TrajectoryStatus")
      .value("Reached", TrajectoryStatus::Reached)
      .value("TooFar", TrajectoryStatus::TooFar)
      .value("Unreachable", TrajectoryStatus::Unreachable);
  m.def("trajectory_advice", &advice, "status"_a);
  nb::class_<Trajectory>(m, "Trajectory", "Held commands and the path that they cause, seen from the start.")
      .def_ro("status", &Trajectory::status)
      .def_ro("gap_xy", &Trajectory::gap_xy)
      .def_ro("gap_yaw", &Trajectory::gap_yaw)
      .def_ro("linearizations", &Trajectory::linearizations)
      .def_prop_ro("t", [](const Trajectory& plan) { return vector_of(plan.t); })
      .def_prop_ro("v", [](const Trajectory& plan) { return vector_of(plan.v); })
      .def_prop_ro("omega", [](const Trajectory& plan) { return vector_of(plan.omega); })
      .def_prop_ro("path_t", [](const Trajectory& plan) { return vector_of(plan.path.t); })
      .def_prop_ro("path", [](const Trajectory& plan) { return pose_matrix(plan.path.poses); })
      .def_prop_ro("drive", [](const Trajectory& plan) { return plan.path.drive; });
  nb::class_<TrajectoryPlanner>(m, "TrajectoryPlanner", "Plans to goal poses from states near its start.")
      .def(
          "__init__",
          [](TrajectoryPlanner* self, const MotionModel& model, const Eigen::VectorXd& parameters,
             const DriveLimits& limits, const TrajectorySettings& settings,
             const DriveStart& start) { new (self) TrajectoryPlanner({model, parameters}, limits, settings, start); },
          "model"_a, "parameters"_a, "limits"_a, "settings"_a, "start"_a)
      .def("to", &TrajectoryPlanner::to, "goal"_a, "start"_a);
}

}  // namespace

void bind_planning(nb::module_& m) {
  using Cells = nb::ndarray<const std::uint8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
  bind_settings(m);
  bind_trajectory(m);
  m.def(
      "distance_field",
      [](const Cells& occupied, double resolution, float nothing) {
        const std::span<const std::uint8_t> cells(occupied.data(), occupied.size());
        const auto field = distance_field(cells, occupied.shape(1), resolution, nothing);
        using Field = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        return Field(Eigen::Map<const Field>(field.data(), static_cast<Eigen::Index>(occupied.shape(0)),
                                             static_cast<Eigen::Index>(occupied.shape(1))));
      },
      "occupied"_a, "resolution"_a, "nothing"_a, "Distance to the nearest occupied cell [m], [rows, columns].");
}

}  // namespace slipwise::bindings
