// SPDX-License-Identifier: Apache-2.0
// Slip that wanders about what was learned, and what the last segments say of where it is now.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "slipwise/estimate/estimate.hpp"
#include "slipwise/estimate/weighing.hpp"
#include "slipwise/motion/motion_noise.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {

struct ColouredSlipSettings {
  /// Candidate standard deviations of a wandering term, as fractions of its prior standard deviation [-].
  std::vector<double> fractions = {0.1, 0.3};
  std::vector<double> time_constants = {5.0, 20.0};  ///< candidates [s]
  double white = 0.5;                                ///< weight beforehand of slip that does not wander [-]
  WeighingSettings weighing{.learning_rate = 1.0, .share = 0.01};
};

/// One guess of how slip wanders: first-order Gauss-Markov processes of one time constant.
struct SlipWander {
  double drift;          ///< of the forward and sideways terms, as a fraction of their prior std [-]
  double turn;           ///< of the angular terms [-]
  double time_constant;  ///< [s]
};

/// A model as it is believed before the segments that it is asked about.
struct MotionBelief {
  MotionModel model;
  Estimate estimate;
  Eigen::VectorXd prior_std;    ///< [parameters]
  MotionNoise shape;            ///< of the noise
  Eigen::Vector3d noise_scale;  ///< learned factor of its variances
};

/// Where a segment is expected to end: chart (x, y, theta) of T_start_end and its covariance.
struct ExpectedPose {
  Eigen::Vector3d pose;
  Eigen::Matrix3d covariance;
};

/// Adds to the shares of V and w in the slip rates a deviation that decays, follows it through the last segments, and
/// carries it into a prediction. How far and how slowly slip wanders is weighed among candidates by what they foretell;
/// the first candidate is that it does not (derivations.md, section 18).
class ColouredSlip {
 public:
  /// \throws std::invalid_argument when a fraction or a time constant is not positive and finite.
  explicit ColouredSlip(const ColouredSlipSettings& settings);

  /// Weighs the candidates by the last of `segments`, foretold from those before it. All in the order of time.
  void learn(const MotionBelief& belief, const InputTrack& inputs, std::span<const Segment> segments);
  /// Predicts `segment` from what `recent` segments, all ended by its start, say of the slip now.
  ExpectedPose predict(const MotionBelief& belief, const InputTrack& inputs, std::span<const Segment> recent,
                       const Segment& segment) const;

  const std::vector<SlipWander>& candidates() const { return candidates_; }
  const Eigen::VectorXd& weights() const { return weights_; }

 private:
  std::vector<SlipWander> candidates_;
  WeighingSettings weighing_;
  Eigen::VectorXd prior_;  ///< weights beforehand
  Eigen::VectorXd weights_;
  std::size_t seen_ = 0;  ///< segments weighed by
};

}  // namespace slipwise
