// SPDX-License-Identifier: Apache-2.0
// How uncertain a segment's last pose is because of slip noise and pose noise (derivations/uncertainty.md).
#pragma once

#include <Eigen/Core>

#include "slipwise/motion/motion_noise.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {

/// Covariance of what the sensors see that the slip noise causes along the path.
RowsCovariance slip_covariance(const SegmentPath& path, const MotionNoise& noise);
/// How what one sensor of three rows sees changes with a slip that is the same fraction of motion all along: column c
/// is one standard deviation of channel c.
Eigen::Matrix3d constant_slip(const SegmentPath& path, const MotionNoise& noise);
/// Covariance of what was measured of a segment with what was of the one before it, where they meet at one measured
/// pose of one source, under a learned scale; empty where they share nothing.
RowsCovariance shared_noise(const Segment& segment, const Segment& before, const MotionNoise& noise,
                            const Eigen::Vector3d& scale);
/// A covariance with a factor of its variances.
RowsCovariance scaled_covariance(const RowsCovariance& covariance, const Rows& scale);
/// Of a measured segment: slip and what its sensors say of their noise, times their own factors. `measured` are the
/// rows of all.
RowsCovariance expected_noise(const SegmentPath& path, const Rows& measured, const MotionNoise& noise);
/// The learned factor of the variance of each row; 1 where that is not of its sensor.
Rows scale_for(const SegmentPath& path, const Eigen::Vector3d& scale);
/// R of a measured segment: the same with a learned factor of the variances of (x, y, theta), where that is theirs.
RowsCovariance segment_noise(const SegmentPath& path, const Rows& measured, const MotionNoise& noise,
                             const Eigen::Vector3d& scale);

}  // namespace slipwise
