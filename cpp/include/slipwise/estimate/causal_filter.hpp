// SPDX-License-Identifier: Apache-2.0
// Learning one model segment by segment: prior that follows the speeds, IEKF update, noise that follows the residuals,
// and the first segments learned anew where noise and linearisation were guesses.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "slipwise/estimate/batch.hpp"
#include "slipwise/estimate/iekf.hpp"
#include "slipwise/estimate/noise_scale.hpp"
#include "slipwise/estimate/prior.hpp"
#include "slipwise/estimate/score_covariance.hpp"
#include "slipwise/estimate/speed_range.hpp"

namespace slipwise {

struct CausalFilterSettings {
  PriorSettings prior = {};
  IekfSettings iekf = {};
  NoiseSettings noise = {};
};

class CausalFilter {
 public:
  CausalFilter(MotionModel model, const CausalFilterSettings& settings);

  /// Learns one segment. `speeds` are those seen up to the segment's end. After 8, 16, ... 256 segments all of them are
  /// learned anew, but not so many for a filter to whose predictions nobody listens (`heard`). The update returned is
  /// that of the segment alone.
  IekfUpdate learn(const InputTrack& inputs, const Segment& segment, const ReferenceSpeeds& speeds, bool heard = true);

  /// Gives the slip parameters `share` of their prior variance back and keeps their mean. Lag, delay and clock are the
  /// robot's, not the ground's: they stay as learned.
  void forget(double share);

  const MotionModel& model() const { return model_; }
  /// What learning goes on from: the noise is taken to be of the shape given.
  const Estimate& estimate() const { return estimate_; }
  /// The same with a covariance that also holds where it is not, or where slip is correlated in time.
  Estimate stated() const;
  /// Standard deviations of the prior now in force, [parameters].
  Eigen::VectorXd prior_std() const;
  /// Learned factor of the noise variances of (x, y, theta).
  Eigen::Vector3d noise_scale() const { return noise_scale_.value(); }
  const NoiseSettings& noise() const { return settings_.noise; }

 private:
  struct Kept {
    InputTrack inputs;
    Segment segment;
  };

  void follow(const ReferenceSpeeds& speeds);
  Eigen::Matrix3d expected_noise(const SegmentLinearization& at, const Segment& segment) const;
  void learn_noise(const SegmentLinearization& at, const Segment& segment);
  void keep(const InputTrack& inputs, const Segment& segment, const SegmentLinearization& at, bool heard);
  void relearn();
  struct KeptData;
  KeptData kept_data() const;

  MotionModel model_;
  CausalFilterSettings settings_;
  ReferenceSpeeds speeds_{};
  bool started_ = false;
  Estimate estimate_;
  Estimate before_;         ///< what was known before the segments that are kept
  std::vector<Kept> kept_;  ///< the first since the start, or since the ground changed
  std::size_t since_ = 0;   ///< segments since then
  Eigen::VectorXd slip_std_;
  NoiseScale noise_scale_;
  ScoreCovariance scores_;
  Eigen::VectorXd stated_;  ///< factors of the standard deviations, as the scores show them
};

/// Covariance of a predicted chart: parameters, slip noise and, where `with_pose_noise`, the two measured poses.
Eigen::Matrix3d prediction_covariance(const SegmentLinearization& at,
                                      const Eigen::Ref<const Eigen::MatrixXd>& parameters, const MotionNoise& shape,
                                      const Eigen::Vector3d& scale);

}  // namespace slipwise
