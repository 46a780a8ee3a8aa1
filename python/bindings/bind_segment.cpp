// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/segment.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "checked_shapes.hpp"
#include "pose_matrix.hpp"
#include "slipwise/segment/foreseen_ground.hpp"
#include "slipwise/segment/ground.hpp"
#include "slipwise/segment/integrate_segment.hpp"
#include "slipwise/segment/segment_covariance.hpp"
#include "slipwise/sensor/sensor_motion.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

void bind_ground(nb::module_& m) {
  nb::class_<ElevationMap>(m, "ElevationMap", "Elevations on a grid, a row for each y, a column for each x.")
      .def(nb::init<Eigen::MatrixXd, Eigen::Vector2d, double>(), "elevation"_a, "origin"_a, "cell"_a)
      .def("height", &ElevationMap::height, "x"_a, "y"_a)
      .def("holds", &ElevationMap::holds, "x"_a, "y"_a);
  nb::class_<Ground>(m, "Ground", "The ground under a segment.")
      .def_static(
          "grade", [](double rise_x, double rise_y) { return std::make_shared<const Ground>(Grade{rise_x, rise_y}); },
          "rise_x"_a, "rise_y"_a, "A plane that rises by this per metre along the axes of the segment's first pose.")
      .def_static(
          "mapped",
          [](std::shared_ptr<const ElevationMap> map, const Pose2& start) {
            return std::make_shared<const Ground>(MappedGround{std::move(map), start});
          },
          "map"_a, "start"_a, "A map, and the segment's first pose on it.")
      .def_static(
          "measured",
          [](const Eigen::MatrixX3d& rows) {
            MeasuredTilts tilts;
            for (const auto& row : rows.rowwise()) {
              tilts.at.push_back({row[0], row[1], row[2]});
            }
            return std::make_shared<const Ground>(std::move(tilts));
          },
          "rows"_a, "An attitude measured along it: rows of (t [s], roll, pitch [rad]) in order of t.")
      .def(
          "standings",
          [](const Ground& ground, const Eigen::MatrixX3d& poses) {
            Eigen::MatrixX3d found(poses.rows(), 3);
            for (Eigen::Index i = 0; i < poses.rows(); ++i) {
              const Standing at = standing_at(ground, Pose2::from_vector(poses.row(i).transpose()));
              found.row(i) << at.z, at.roll, at.pitch;
            }
            return found;
          },
          "poses"_a, "Height above the first pose, roll and pitch, [N, 3], at poses [N, 3] seen from it.");
}

}  // namespace

void bind_segment(nb::module_& m) {
  bind_ground(m);
  nb::class_<Segment>(m, "Segment", "Two measured poses of one drive.")
      .def(
          "__init__",
          [](Segment* self, double start, double end, const Pose2& measured, std::optional<BodyTwist> initial,
             double gx, double gy) {
            new (self) Segment{.start = start,
                               .end = end,
                               .measured = measured_pose(measured),
                               .initial = initial,
                               .gx = gx,
                               .gy = gy};
          },
          "start"_a, "end"_a, "measured"_a, "initial"_a.none(), "gx"_a, "gy"_a)
      .def(
          "with_measured_actuator",
          [](const Segment& segment, std::shared_ptr<const InputHistory> twist, double until,
             const BodyTwist& initial) {
            Segment known = segment;
            known.initial = initial;
            known.known = MeasuredActuator{.twist = std::move(twist), .until = until, .any_inputs = true};
            return known;
          },
          "twist"_a, "until"_a, "initial"_a,
          "The same segment where the drive's twist is known until a moment in input stamps [s], `initial` at that "
          "moment, and any inputs may follow.")
      .def(
          "with_sensor",
          [](const Segment& segment, const Pose2& sensor) {
            Segment observed = segment;
            for (Measured& each : observed.measured) {
              each.sensor.place = sensor;
            }
            return observed;
          },
          "sensor"_a, "The same segment, measured by a sensor at this pose in base_link.")
      .def(
          "with_heading",
          [](const Segment& segment, double heading) {
            Segment headed = segment;
            headed.heading = heading;
            return headed;
          },
          "heading"_a, "The same segment, its first pose headed like this in the frame of the poses [rad].")
      .def(
          "with_ground",
          [](const Segment& segment, std::shared_ptr<const Ground> ground) {
            Segment tilted = segment;
            tilted.ground = std::move(ground);
            return tilted;
          },
          "ground"_a.none(), "The same segment on other ground, level where it is None.")
      .def(
          "foreseen",
          [](const Segment& segment) {
            Segment ahead = segment;
            ahead.ground = foreseen_ground(segment.ground);
            return ahead;
          },
          "The same segment as far as it is known when it begins: on the plane that its first attitude tells of.")
      .def_ro("ground", &Segment::ground)
      .def_ro("start", &Segment::start)
      .def_ro("end", &Segment::end)
      .def_prop_ro(
          "measured",
          [](const Segment& s) { return Pose2::from_vector(chart_of(directions_of(s.measured), rows_of(s.measured))); })
      .def_ro("heading", &Segment::heading)
      .def_ro("gx", &Segment::gx)
      .def_ro("gy", &Segment::gy)
      .def_prop_ro(
          "measured_actuator", [](const Segment& segment) { return segment.known ? segment.known->twist : nullptr; },
          "What was measured of the drive's twist, None where it was not.");
  nb::enum_<Integrator>(m, "Integrator").value("Exact", Integrator::Exact).value("Rk4", Integrator::Rk4);
  nb::class_<SegmentPath>(m, "SegmentPath", "The robot's path seen from its start.")
      .def_prop_ro("times",
                   [](const SegmentPath& p) -> Eigen::VectorXd {
                     return Eigen::Map<const Eigen::VectorXd>(p.times.data(),
                                                              static_cast<Eigen::Index>(p.times.size()));
                   })
      .def_prop_ro("poses", [](const SegmentPath& p) { return pose_matrix(p.poses); })
      .def_prop_ro(
          "sensor_poses",
          [](const SegmentPath& p) {
            std::vector<Pose2> observed;
            for (const Pose2& pose : p.poses) {
              observed.push_back(sensor_motion(pose, p.sensor()));
            }
            return pose_matrix(observed);
          },
          "The path of the sensor that measures it, seen from its start.")
      .def("robot_motion", &SegmentPath::robot_motion, "measured"_a,
           "The robot's motion that this motion of the sensor tells.");
  nb::class_<SegmentLinearization>(m, "SegmentLinearization",
                                   "A path, and where it leads the pose sensor, with the derivative.")
      .def_ro("path", &SegmentLinearization::path)
      .def_prop_ro("predicted", &SegmentLinearization::pose)
      .def_prop_ro("by_parameter", [](const SegmentLinearization& at) -> Eigen::MatrixXd { return at.by_parameter; });
  m.attr("TURN_RADIUS") = kTurnRadius;
  m.attr("STRAIGHT_RADIUS") = kStraightRadius;
  nb::class_<MotionNoise>(m, "MotionNoise", "Noise of slip rates and poses.")
      .def(
          "__init__",
          [](MotionNoise* self, std::array<double, 3> psd_time, std::array<double, 3> psd_motion,
             std::array<double, 3> fraction, double pose_std_xy, double pose_std_yaw) {
            new (self) MotionNoise{psd_time, psd_motion, fraction, pose_std_xy, pose_std_yaw};
          },
          "psd_time"_a, "psd_motion"_a, "fraction"_a, "pose_std_xy"_a, "pose_std_yaw"_a)
      .def_ro("psd_time", &MotionNoise::psd_time)
      .def_ro("psd_motion", &MotionNoise::psd_motion)
      .def_ro("fraction", &MotionNoise::fraction)
      .def_ro("pose_std_xy", &MotionNoise::pose_std_xy)
      .def_ro("pose_std_yaw", &MotionNoise::pose_std_yaw);
  m.def(
      "integrate_segment",
      [](const MotionModel& model, const Eigen::VectorXd& parameters, const InputHistory& inputs,
         const Segment& segment,
         Integrator integrator) { return integrate_segment(model, parameters, inputs, segment, integrator); },
      "model"_a, "parameters"_a, "inputs"_a, "segment"_a, "integrator"_a);
  m.def(
      "linearize_segment",
      [](const MotionModel& model, const Eigen::VectorXd& parameters, const InputHistory& inputs,
         const Segment& segment) { return linearize_segment(model, parameters, inputs, segment); },
      "model"_a, "parameters"_a, "inputs"_a, "segment"_a);
  m.def(
      "slip_covariance",
      [](const SegmentPath& path, const MotionNoise& noise) -> Eigen::MatrixXd { return slip_covariance(path, noise); },
      "path"_a, "noise"_a);
  m.def(
      "segment_noise",
      [](const SegmentPath& path, const Segment& segment, const MotionNoise& noise, const Eigen::Vector3d& scale)
          -> Eigen::MatrixXd { return segment_noise(path, rows_of(segment.measured), noise, scale); },
      "path"_a, "segment"_a, "noise"_a, "scale"_a,
      "Covariance of what was measured of a segment that takes this path: slip and the sensors' own noise.");
  m.def(
      "pose_noise_covariance",
      [](const Pose2& measured, const MotionNoise& noise) { return pose_noise_covariance(measured, noise); },
      "measured"_a, "noise"_a);
}

}  // namespace slipwise::bindings
