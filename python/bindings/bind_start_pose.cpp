// SPDX-License-Identifier: Apache-2.0
// Bindings of where a prediction starts.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "slipwise/estimate/start_pose.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

SeenPoses seen_poses(const std::vector<double>& stamps, const Eigen::MatrixX3d& rows) {
  if (rows.rows() != std::ssize(stamps)) {
    throw std::invalid_argument("each pose needs a stamp, got " + std::to_string(stamps.size()) + " stamps and " +
                                std::to_string(rows.rows()) + " poses");
  }
  SeenPoses seen{.stamps = stamps, .poses = {}};
  for (const auto& row : rows.rowwise()) {
    seen.poses.push_back(Pose2::from_vector(row.transpose()));
  }
  return seen;
}

}  // namespace

void bind_start_pose(nb::module_& m) {
  nb::class_<StartPoseSettings>(m, "StartPoseSettings")
      .def(nb::init<>())
      .def_rw("memories", &StartPoseSettings::memories)
      .def_rw("measured", &StartPoseSettings::measured)
      .def_rw("weighing", &StartPoseSettings::weighing);
  nb::class_<SeenPoses>(m, "SeenPoses", "Stamps [M] and poses [M, 3] of the sensor until a prediction starts.")
      .def(
          "__init__",
          [](SeenPoses* self, const std::vector<double>& stamps, const Eigen::MatrixX3d& poses) {
            new (self) SeenPoses(seen_poses(stamps, poses));
          },
          "stamps"_a, "poses"_a)
      .def_ro("stamps", &SeenPoses::stamps);
  nb::class_<StartLaw>(m, "StartLaw", "How far back poses tell of a start: guesses [s] and how likely each is.")
      .def(
          "__init__",
          [](StartLaw* self, const std::vector<double>& memories, const Eigen::VectorXd& weights) {
            new (self) StartLaw{memories, weights};
          },
          "memories"_a, "weights"_a)
      .def_ro("memories", &StartLaw::memories)
      .def_ro("weights", &StartLaw::weights);
  nb::class_<StartPose>(m, "StartPose", "Where a prediction starts, from the poses shortly before it.")
      .def(nb::init<const StartPoseSettings&>(), "settings"_a)
      .def(nb::init<StartLaw>(), "law"_a)
      .def(nb::init<const StartPose&>(), "other"_a)
      .def("learn", &StartPose::learn, "belief"_a, "inputs"_a, "seen"_a, "segment"_a, "expected"_a,
           "Weighs the memories by a segment, whose end was expected from its measured start.")
      .def("offset", &StartPose::offset, "belief"_a, "inputs"_a, "seen"_a, "segment"_a,
           "Where the sensor is at a segment's start, as seen from the pose measured there.")
      .def_prop_ro("law", &StartPose::law)
      .def_prop_ro("reach", &StartPose::reach, "Poses older than this count for nothing [s].");
  m.def("starting_at", &starting_at, "offset"_a, "expected"_a, "The same end from a start that lies elsewhere.");
}

}  // namespace slipwise::bindings
