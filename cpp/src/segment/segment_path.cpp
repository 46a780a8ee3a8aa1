// SPDX-License-Identifier: Apache-2.0
// What sensors see of a path.
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

View view_of(const Sight& sight, const std::array<Pose2, kMostMoments>& robot, const Pose2& place, Rows measured) {
  return {.robot = std::span(robot).first(static_cast<std::size_t>(sight.stamps.size())),
          .stamps = sight.stamps,
          .place = place,
          .measured = std::move(measured)};
}

}  // namespace

std::vector<Seen> SegmentPath::seen() const {
  std::vector<Seen> all;
  all.reserve(sights.size());
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const auto robot = sights[i].robot(poses);
    const auto& [sensor, z] = measured[i];
    all.push_back(see(sensor, view_of(sights[i], robot, sensor.place, z)));
  }
  return all;
}

RowsCovariance SegmentPath::measurement_noise(const Rows& rows, const MotionNoise& noise) const {
  RowsCovariance all = RowsCovariance::Zero(rows.size(), rows.size());
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const auto robot = sights[i].robot(poses);
    const auto& [sensor, z] = measured[i];
    const Rows own = rows.segment(row, z.size());
    all.block(row, row, z.size(), z.size()) =
        slipwise::measurement_noise(sensor, view_of(sights[i], robot, sensor.place, own), noise);
    row += z.size();
  }
  return all;
}

Pose2 SegmentPath::robot_motion(const Pose2& motion) const {
  return compose(compose(sensor(), motion), inverse(sensor()));
}

Rows error_of(const Segment& segment, const SegmentLinearization& at) {
  return rows_of(segment.measured) - at.predicted;
}

Rows shorter_error_of(const Segment& segment, const SegmentLinearization& at) {
  return shorter_error(at.path.directions(), rows_of(segment.measured), at.predicted);
}

}  // namespace slipwise
