// SPDX-License-Identifier: Apache-2.0
// Levenberg-Marquardt MAP over all segments at once, with a Huber loss.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "slipwise/actuator/input_track.hpp"
#include "slipwise/estimate/estimate.hpp"
#include "slipwise/motion/motion_model.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {

struct BatchSettings {
  int iterations = 30;      ///< at most
  double tolerance = 1e-8;  ///< relative decrease of the cost that counts as converged [-]
  double huber = 2.5;       ///< a residual of more than this many sigma counts for less [-]
  /// Where the search starts [parameters]; empty: at the prior's mean.
  Eigen::VectorXd start = {};
};

/// A segment, the inputs that it belongs to, and the covariance R of its measured chart.
struct BatchDatum {
  const InputTrack* inputs;
  Segment segment;
  Eigen::Matrix3d noise;
  /// Covariance of its error with that of the datum before.
  Eigen::Matrix3d shared = Eigen::Matrix3d::Zero();
};

struct BatchFit {
  Estimate estimate;
  double cost;     ///< robust MAP cost at the estimate
  int iterations;  ///< used
  Status status;
  std::vector<SegmentLinearization> at;  ///< the data, at the estimate
};

/// `at_start` are the data at the search's start, where they were linearised there before.
/// \throws std::invalid_argument when sizes do not fit or there is no datum.
BatchFit batch_fit(const MotionModel& model, const Estimate& prior, std::span<const BatchDatum> data,
                   const BatchSettings& settings = {}, std::vector<SegmentLinearization> at_start = {});

}  // namespace slipwise
