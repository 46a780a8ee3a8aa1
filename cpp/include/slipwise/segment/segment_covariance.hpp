// SPDX-License-Identifier: Apache-2.0
// How uncertain a segment's last pose is because of slip noise and pose noise (derivations/uncertainty.md).
#pragma once

#include <Eigen/Core>
#include <array>

#include "slipwise/motion/motion_noise.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {

/// Covariance of the chart (x, y, theta) of T_start_end of the pose sensor that the slip noise causes along the path.
Eigen::Matrix3d slip_covariance(const SegmentPath& path, const MotionNoise& noise);
/// How the chart of T_start_end of the pose sensor changes with a slip that is the same fraction of motion all along:
/// column c is one standard deviation of channel c.
Eigen::Matrix3d constant_slip(const SegmentPath& path, const MotionNoise& noise);
/// Covariance of a measured T_start_end because both poses are measured: H R1 H^T + R2, with each pose's
/// standard deviations times its ratios.
Eigen::Matrix3d pose_noise_covariance(const Pose2& measured, const MotionNoise& noise,
                                      const std::array<PoseStdRatio, 2>& ratio = {});
/// The same of the segment that `path` predicts, along which `measured` was driven; between positions, noise goes
/// through all that make the courses.
Eigen::Matrix3d pose_noise_covariance(const SegmentPath& path, const Pose2& measured, const MotionNoise& noise);
/// Covariance of the chart of a measured motion with that of the one before it, where they meet at one measured pose.
Eigen::Matrix3d shared_pose_noise(const Pose2& measured, const Pose2& before, const MotionNoise& noise,
                                  const PoseStdRatio& ratio = {});
/// A covariance of (x, y, theta) with a factor of its variances.
Eigen::Matrix3d scaled_covariance(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& scale);
/// Of a measured segment: slip and both poses, times the factor of the source that measures it.
Eigen::Matrix3d expected_noise(const SegmentPath& path, const Pose2& measured, const MotionNoise& noise);
/// The learned factor of its variances that goes with what measures the segment.
Eigen::Vector3d scale_for(const SegmentPath& path, const Eigen::Vector3d& scale);
/// R of a measured segment: the same with a factor of the variances of (x, y, theta).
Eigen::Matrix3d segment_noise(const SegmentPath& path, const Pose2& measured, const MotionNoise& noise,
                              const Eigen::Vector3d& scale);

}  // namespace slipwise
