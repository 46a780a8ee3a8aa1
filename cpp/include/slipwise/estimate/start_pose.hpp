// SPDX-License-Identifier: Apache-2.0
// Where a prediction starts: the pose measured then, and those shortly before it, carried there by the model.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "slipwise/estimate/coloured_slip.hpp"
#include "slipwise/estimate/weighing.hpp"
#include "slipwise/lie/se2.hpp"
#include "slipwise/segment/segment.hpp"

namespace slipwise {

struct StartPoseSettings {
  std::vector<double> memories = {0.1, 0.2, 0.4};  ///< candidates: age at which a pose counts 1/e of the last [s]
  double measured = 0.9;                           ///< weight beforehand of the last pose alone [-]
  WeighingSettings weighing{.learning_rate = 1.0, .share = 0.01};
};

/// Poses of the pose sensor, in any frame that holds still, until a prediction starts.
struct SeenPoses {
  std::vector<double> stamps;  ///< [s], increasing; the last is the start
  std::vector<Pose2> poses;
};

/// How far back poses tell of the start, as far as it is known: guesses and how likely each is.
struct StartLaw {
  std::vector<double> memories;  ///< [s]; zero: the last pose alone
  Eigen::VectorXd weights;       ///< not negative, their sum is 1
};

/// Averages the noise of poses out of a prediction's start: each of the last poses, and the motion that the model says
/// came after it, tells where the robot is now. How fast older ones count less is weighed among candidates by what they
/// foretell; the first candidate is the last pose alone (derivations.md, section 20).
class StartPose {
 public:
  /// \throws std::invalid_argument when a memory is not positive and finite.
  explicit StartPose(const StartPoseSettings& settings);
  /// As it was learned before, to predict with.
  /// \throws std::invalid_argument when there is not one weight per memory, one of either is negative or not finite, or
  /// the weights' sum is not 1.
  explicit StartPose(StartLaw law);

  /// Weighs the candidates by `segment`, whose end was `expected` from its measured start.
  void learn(const MotionPosterior& belief, const InputTrack& inputs, const SeenPoses& seen, const Segment& segment,
             const ExpectedPose& expected);
  /// Where the sensor is at the start of `segment`, as seen from the pose measured there.
  /// \throws std::invalid_argument when the stamps do not increase to the segment's start, or a pose lacks its stamp.
  Pose2 offset(const MotionPosterior& belief, const InputTrack& inputs, const SeenPoses& seen,
               const Segment& segment) const;

  const StartLaw& law() const { return law_; }
  /// Poses older than this count for nothing [s].
  double reach() const;

 private:
  StartLaw law_;
  WeighingSettings weighing_;
  Eigen::VectorXd prior_;  ///< weights beforehand
  std::size_t seen_ = 0;   ///< segments weighed by
};

/// The same end from a start that lies elsewhere; the covariance turns with it.
ExpectedPose starting_at(const Pose2& offset, const ExpectedPose& expected);

}  // namespace slipwise
