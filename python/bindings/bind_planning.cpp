// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/planning.
#include <nanobind/eigen/dense.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "slipwise/planning/distance_field.hpp"
#include "slipwise/planning/mppi.hpp"
#include "slipwise/planning/trajectory.hpp"
#include "slipwise/slip/mixed_ahead.hpp"

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

void bind_planner_settings(nb::module_& m) {
  nb::class_<DriveLimits>(m, "DriveLimits", "Limits of the commands [m/s, rad/s, 1/m, m/s^2].")
      .def(nb::init<double, double, double, double>(), "speed"_a, "yaw_rate"_a, "curvature"_a, "acceleration"_a)
      .def("check", &DriveLimits::check);
  nb::class_<ActuatorState>(m, "ActuatorState", "What the drive does and was commanded last when a plan begins.")
      .def(nb::init<BodyTwist, BodyTwist, std::optional<BodyTwist>>(), "drive"_a, "commanded"_a, "fast"_a.none());
  nb::class_<TrajectorySettings>(m, "TrajectorySettings", "How trajectories are shaped.")
      .def(nb::init<>())
      .def_rw("cruise", &TrajectorySettings::cruise)
      .def_rw("end_speed", &TrajectorySettings::end_speed)
      .def_rw("rest_speed", &TrajectorySettings::rest_speed)
      .def_rw("rest_yaw_rate", &TrajectorySettings::rest_yaw_rate)
      .def_rw("longest", &TrajectorySettings::longest)
      .def_rw("backwards", &TrajectorySettings::backwards)
      .def_rw("straight_end", &TrajectorySettings::straight_end)
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
  m.def("trajectory_advice", [](TrajectoryStatus status) { return advice(status); }, "status"_a);
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
      .def_prop_ro("drive", [](const Trajectory& plan) { return plan.path.drive; })
      .def_prop_ro("fast", [](const Trajectory& plan) { return plan.path.fast; });
  nb::class_<TrajectoryPlanner>(m, "TrajectoryPlanner", "Plans to goal poses from states near its start.")
      .def(
          "__init__",
          [](TrajectoryPlanner* self, const MotionModel& model, const Eigen::VectorXd& parameters,
             const DriveLimits& limits, const TrajectorySettings& settings, const ActuatorState& start,
             const CommandLimits* of_drive) {
            const CommandLimits learned = of_drive == nullptr ? CommandLimits{} : *of_drive;
            new (self) TrajectoryPlanner({model, parameters, learned}, limits, settings, start);
          },
          "model"_a, "parameters"_a, "limits"_a, "settings"_a, "start"_a, "of_drive"_a.none(),
          "Commands are planned within `limits`; those `of_drive` lie behind the commands.")
      .def("to", &TrajectoryPlanner::to, "goal"_a, "start"_a, "ground"_a.none() = nb::none());
}

void bind_mppi_settings(nb::module_& m) {
  nb::class_<MppiLimits>(m, "MppiLimits", "Limits of sampled commands.")
      .def(nb::init<>())
      .def_rw("lowest_speed", &MppiLimits::lowest_speed)
      .def_rw("highest_speed", &MppiLimits::highest_speed)
      .def_rw("yaw_rate", &MppiLimits::yaw_rate)
      .def_rw("acceleration", &MppiLimits::acceleration)
      .def_rw("yaw_acceleration", &MppiLimits::yaw_acceleration)
      .def_rw("sideways_speed", &MppiLimits::sideways_speed)
      .def_rw("sideways_acceleration", &MppiLimits::sideways_acceleration);
  nb::class_<MppiCosts>(m, "MppiCosts", "What costs how much.")
      .def(nb::init<>())
      .def_rw("across", &MppiCosts::across)
      .def_rw("along", &MppiCosts::along)
      .def_rw("heading", &MppiCosts::heading)
      .def_rw("smoothness", &MppiCosts::smoothness)
      .def_rw("obstacle", &MppiCosts::obstacle)
      .def_rw("collision", &MppiCosts::collision)
      .def_rw("lethal", &MppiCosts::lethal);
  nb::class_<MppiSettings>(m, "MppiSettings", "Settings of the MPPI controller.")
      .def(nb::init<>())
      .def_rw("rollouts", &MppiSettings::rollouts)
      .def_rw("periods", &MppiSettings::periods)
      .def_rw("period", &MppiSettings::period)
      .def_rw("speed_std", &MppiSettings::speed_std)
      .def_rw("yaw_rate_std", &MppiSettings::yaw_rate_std)
      .def_rw("sideways_std", &MppiSettings::sideways_std)
      .def_rw("colour", &MppiSettings::colour)
      .def_rw("temperature", &MppiSettings::temperature)
      .def_rw("risk", &MppiSettings::risk)
      .def_rw("seed", &MppiSettings::seed)
      .def_rw("limits", &MppiSettings::limits)
      .def_rw("costs", &MppiSettings::costs);
}

template <int kColumns>
using PlannedRows = nb::ndarray<const double, nb::shape<-1, kColumns>, nb::c_contig, nb::device::cpu>;

/// Rows are (v, vy, omega).
DriveCommand command_of(const double* row) { return {.v = row[0], .omega = row[2], .vy = row[1]}; }

std::vector<DriveCommand> commands_of(const PlannedRows<3>& rows) {
  std::vector<DriveCommand> commands;
  for (std::size_t i = 0; i < rows.shape(0); ++i) {
    commands.push_back(command_of(&rows(i, 0)));
  }
  return commands;
}

MppiReference reference_of(const PlannedRows<3>& rows) {
  MppiReference reference;
  for (std::size_t i = 0; i < rows.shape(0); ++i) {
    reference.x.push_back(static_cast<float>(rows(i, 0)));
    reference.y.push_back(static_cast<float>(rows(i, 1)));
    reference.theta.push_back(static_cast<float>(rows(i, 2)));
  }
  return reference;
}

/// Model, parameters, limits, the rise of the ground per metre along the axes of the poses' frame, the slip ahead, and
/// whether it drives sideways.
using Motions = std::vector<std::tuple<MotionModel, Eigen::VectorXd, std::optional<CommandLimits>,
                                       std::array<double, 2>, std::optional<MixedAhead>, bool>>;

std::vector<RolloutProgram> programs_of(const Motions& motions, double period) {
  std::vector<RolloutProgram> programs;
  for (const auto& [model, parameters, limits, rise, ahead, sideways] : motions) {
    programs.emplace_back(model, parameters,
                          RolloutSetting{.period = period,
                                         .limits = limits.value_or(CommandLimits{}),
                                         .rise_x = rise[0],
                                         .rise_y = rise[1],
                                         .ahead = ahead ? ahead->ahead : SlipAhead{},
                                         .sideways = sideways});
  }
  return programs;
}

void bind_mppi(nb::module_& m) {
  nb::class_<MppiResult>(m, "MppiResult", "The next command and the plan that it begins.")
      .def_prop_ro("command",
                   [](const MppiResult& result) {
                     return Eigen::Vector3d(result.command.v, result.command.vy, result.command.omega);
                   })
      .def_prop_ro("plan",
                   [](const MppiResult& result) {
                     Eigen::MatrixX3d plan(static_cast<Eigen::Index>(result.plan.size()), 3);
                     for (std::size_t k = 0; k < result.plan.size(); ++k) {
                       plan.row(static_cast<Eigen::Index>(k)) << result.plan[k].v, result.plan[k].vy,
                           result.plan[k].omega;
                     }
                     return plan;
                   })
      .def_ro("best_cost", &MppiResult::best_cost)
      .def_ro("effective", &MppiResult::effective)
      .def_ro("collides", &MppiResult::collides);
  nb::class_<Mppi>(m, "Mppi", "Model predictive path integral control through learned models.")
      .def(
          "__init__",
          [](Mppi* self, const Motions& models, const MppiSettings& settings, std::optional<CarCurves> car) {
            new (self) Mppi(programs_of(models, settings.period), settings, std::move(car));
          },
          "models"_a, "settings"_a, "car"_a.none())
      .def(
          "step",
          [](Mppi& self, const Pose2& pose, const Eigen::Vector3d& drive, const PlannedRows<3>& past,
             const PlannedRows<3>& reference, const Costmap* map) {
            const MppiState state{.start = {.pose = pose, .drive = command_of(drive.data())},
                                  .past = commands_of(past)};
            return self.step(state, reference_of(reference), map);
          },
          "pose"_a, "drive"_a, "past"_a, "reference"_a, "map"_a.none(),
          "One iteration from the last plan; drive and rows of the past are (v, vy, omega).")
      .def(
          "adopt",
          [](Mppi& self, const Motions& models, std::optional<CarCurves> car) {
            self.adopt(programs_of(models, self.settings().period), std::move(car));
          },
          "models"_a, "car"_a.none(), "Drives through other models from the next step on; the last plan stays.")
      .def(
          "reset", [](Mppi& self, const Eigen::Vector3d& command) { self.reset(command_of(command.data())); },
          "command"_a);
}

}  // namespace

void bind_planning(nb::module_& m) {
  using Cells = nb::ndarray<const std::uint8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
  bind_planner_settings(m);
  bind_trajectory(m);
  bind_mppi_settings(m);
  bind_mppi(m);
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
