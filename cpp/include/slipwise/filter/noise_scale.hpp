// SPDX-License-Identifier: Apache-2.0
// How large the noise of segments really is: a factor of its variances, learned from the residuals.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <utility>

#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise {

/// Noise of segments: a shape that grows with the motion, and a learned factor of the variances of (x, y, theta).
struct NoiseSettings {
  MotionNoise shape{.psd_time = {0.0, 0.0, 0.0},
                    .psd_motion = {1e-3, 1e-3, 1e-3},
                    .fraction = {0.05, 0.05, 0.05},
                    .pose_std_xy = 0.02,
                    .pose_std_yaw = 0.01};
  bool adapt = true;            ///< learn the factor from the residuals
  double prior_segments = 5.0;  ///< the shape counts as much as this many segments [-]
  double forgetting_time =
      40.0;              ///< the factor is a mean over about this many segments, so that it follows the terrain [-]
  double largest = 9.0;  ///< a squared residual counts at most this many times its expected value [-]
};

/// Errors of rows: their squares, which part of these the parameters explain, and the variances of the shape of noise.
struct RowErrors {
  Rows squared;
  Rows open;
  Rows expected;
};

class NoiseScale {
 public:
  explicit NoiseScale(const NoiseSettings& settings = {}) : settings_(settings) {}
  /// As it was learned before; it follows the next residuals as fast as those of the first segments.
  NoiseScale(const NoiseSettings& settings, Eigen::Vector3d value)
      : settings_(settings), value_(std::move(value)), segments_(settings.prior_segments) {}

  /// Learned factor of the noise variances of (x, y, theta).
  const Eigen::Vector3d& value() const { return value_; }
  /// One step of expectation-maximisation: the residual after the update plus what the parameters leave open.
  /// `expected` are the variances of the shape. Does nothing if the settings fix the noise.
  /// `at` is the segment at the estimate whose covariance is given.
  void learn(const SegmentLinearization& at, const Eigen::MatrixXd& covariance, const Segment& segment,
             const Rows& expected);
  /// Follows the next residuals as fast as those of the first segments, from the present value.
  void reset_gain() { segments_ = std::min(segments_, settings_.prior_segments); }
  /// The same as `learn` for a model that never learns the segment, whose rows have these directions.
  void learn_prediction(const Directions& directions, const RowErrors& shown);

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.settings_, self.value_, self.segments_);
  }

 private:
  void follow(const Directions& directions, const Rows& squared, const Rows& expected);

  NoiseSettings settings_;
  Eigen::Vector3d value_ = {1.0, 1.0, 1.0};
  double segments_ = 0.0;
};

}  // namespace slipwise
