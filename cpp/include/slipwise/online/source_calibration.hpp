// SPDX-License-Identifier: Apache-2.0
// How late the stamps of a source of poses are, and where it sits, learned beside the motion model.
#pragma once

#include <Eigen/Core>

#include "slipwise/filter/estimate.hpp"
#include "slipwise/filter/iekf.hpp"
#include "slipwise/filter/motion_posterior.hpp"
#include "slipwise/online/pose_source.hpp"
#include "slipwise/segment/driven_segment.hpp"

namespace slipwise {

/// What a source measures is held against what the model predicts, whose own uncertainty is noise here: the model
/// learns nothing of it (a Schmidt-Kalman filter the other way round).
class SourceCalibration {
 public:
  SourceCalibration() : SourceCalibration(SourceSettings{}) {}
  explicit SourceCalibration(const SourceSettings& settings);

  /// The segment when it really was, seen by the sensor where it really sits.
  Segment corrected(const Segment& segment) const { return placed(segment, estimate_.mean); }
  /// Learns from a segment, as its source stamped it.
  void learn(const MotionPosterior& posterior, const DrivenSegment& driven, const IekfSettings& settings);
  /// Variances of the rows of the segment that what is not known of the source causes, over those of its noise.
  Rows open(const MotionPosterior& posterior, const DrivenSegment& driven) const;
  /// Of the lateness [s], and of x, y [m] and yaw [rad] in base_link.
  const Estimate& estimate() const { return estimate_; }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.estimate_);
  }

 private:
  static Segment placed(const Segment& segment, const Eigen::VectorXd& at);
  struct Seen;

  Estimate estimate_;
};

}  // namespace slipwise
