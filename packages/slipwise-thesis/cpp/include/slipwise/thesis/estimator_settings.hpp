// SPDX-License-Identifier: Apache-2.0
// Settings of the estimators, each under its own name.
#pragma once

#include "slipwise/filter/iekf.hpp"
#include "slipwise/segment/segment_covariance.hpp"
#include "slipwise/thesis/thesis_jacobian.hpp"

namespace slipwise {

/// Thesis 6.2. The thesis gives no values; these follow 20 updates a second.
struct GradientDescentSettings {
  double learning_rate = 0.1;  ///< gamma of (6.12) [-]
  double damping = 1e-2;       ///< l of J^T (J J^T + l I)^-1 [m^2, rad^2]
  SegmentJacobian jacobian = SegmentJacobian::Exact;
};

/// Thesis 6.3, Table 6.1.
struct EkfThesisSettings {
  double process_std = 1e-3;  ///< of each parameter per update, as a fraction of its prior standard deviation [-]
  SegmentJacobian jacobian = SegmentJacobian::Thesis;
};

struct DelayedStateSettings {
  int iterations = 3;  ///< linearisations per pose, the first where an IEKF of the segment alone settles
};

struct EstimatorSettings {
  MotionNoise noise = {};  ///< of slip and poses
  IekfSettings iekf = {};  ///< also gate and Huber weight of `delayed-state`, the latter of `batch`
  GradientDescentSettings gradient_descent = {};
  EkfThesisSettings ekf_thesis = {};
  DelayedStateSettings delayed_state = {};
};

}  // namespace slipwise
