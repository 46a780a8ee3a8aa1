// SPDX-License-Identifier: Apache-2.0
// Thesis (6.7), integrated exactly over each step of constant twist.
#include "slipwise/thesis/thesis_jacobian.hpp"

#include <vector>

#include "slipwise/sensor/sensor_motion.hpp"

namespace slipwise {

Eigen::Matrix<double, 3, Eigen::Dynamic> thesis_jacobian(const MotionModel& model, const SegmentLinearization& at,
                                                         const Segment& segment) {
  const Basis& basis = model.basis();
  motion_of(segment.measured);
  Eigen::Matrix<double, 3, Eigen::Dynamic> jacobian = at.by_parameter;
  jacobian.leftCols(model.slip_size()).setZero();
  std::vector<double> features(basis.size());
  for (std::size_t k = 0; k < at.path.drive.size(); ++k) {
    const ActuatorStep& step = at.path.drive[k];
    if (!(step.duration > 0.0)) {
      continue;
    }
    const double v = step.forward / step.duration, omega = step.turn / step.duration;
    basis.features({.v = v, .omega = omega, .gx = segment.gx, .gy = segment.gy}, features);
    Eigen::Matrix3d gamma = Eigen::Matrix3d::Identity();  // mean of (6.9) over the step
    gamma.topLeftCorner<2, 2>() = rotation(at.path.poses[k].theta) * arc_matrix(arc_functions(at.path.tangents[k].z()));
    for (std::size_t i = 0; i < basis.size(); ++i) {
      const auto channel = static_cast<Eigen::Index>(basis.channel(i));
      jacobian.col(static_cast<Eigen::Index>(i)) += gamma.col(channel) * (features[i] * step.duration);
    }
  }
  const Eigen::Matrix3d observed = sensor_by_robot(at.path.poses.back(), at.path.sensor());
  jacobian.leftCols(model.slip_size()) = (observed * jacobian.leftCols(model.slip_size())).eval();
  return jacobian;
}

RowsJacobian segment_jacobian(SegmentJacobian kind, const MotionModel& model, const SegmentLinearization& at,
                              const Segment& segment) {
  return kind == SegmentJacobian::Exact ? at.by_parameter : RowsJacobian(thesis_jacobian(model, at, segment));
}

}  // namespace slipwise
