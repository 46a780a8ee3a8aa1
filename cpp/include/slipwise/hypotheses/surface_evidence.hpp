// SPDX-License-Identifier: Apache-2.0
// How likely segments are, together, on a surface that is known: their joint density under what was learned and the
// slip disturbance.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slipwise/filter/estimate.hpp"
#include "slipwise/filter/hypothesis_bank.hpp"
#include "slipwise/motion/disturbance_model.hpp"
#include "slipwise/motion/motion_model.hpp"
#include "slipwise/motion/motion_noise.hpp"
#include "slipwise/segment/segment.hpp"

namespace slipwise {

/// The estimate of a surface before the segments that are judged.
struct SurfacePosterior {
  Estimate estimate;
  std::vector<Estimate> jumped = {};  ///< what may be known instead, as likely as each other; empty: it is as it was
  Eigen::VectorXd prior_std;          ///< [parameters]
  MotionNoise noise;                  ///< model of the noise,
  Eigen::Vector3d noise_scale;        ///< and the learned factor of its variances
};

/// The density of each segment given those before it: Kalman filters over the parameters and the disturbance of slip,
/// so that segments which miss alike count as what they have in common, not one by one
/// (derivations/surfaces.md).
class SurfaceEvidence {
 public:
  SurfaceEvidence() = default;
  /// `law` is the slip disturbance as it is known; candidates of it that hardly weigh are passed over.
  SurfaceEvidence(const MotionModel& model, SurfacePosterior posterior, const DisturbanceModel& law);

  /// Log density of a segment given those that were added before, a Student-t's, without constants. The segment follows
  /// them in time, or begins another run.
  double add(const MotionModel& model, const InputHistory& inputs, const Segment& segment);

  /// \throws std::invalid_argument where a loaded one does not fit the model.
  void check_loaded(const MotionModel& model) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.posterior_, self.places_, self.under_, self.time_);
  }

 private:
  /// The estimate under one candidate of the disturbance.
  struct Under {
    double time_constant;        ///< [s]
    Eigen::VectorXd nominal;     ///< [places] variances before anything recent is known
    Eigen::VectorXd state;       ///< [parameters + places], of the parameters what they differ by from the posterior
    Eigen::MatrixXd covariance;  ///< of it

    void decay(double seconds);
    /// Returns the log score of the innovation.
    double learn(const Rows& innovation, const RowsJacobian& by_state, const RowsCovariance& noise);
  };

  SurfacePosterior posterior_;
  std::vector<Eigen::Index> places_;  ///< of the disturbed terms
  HypothesisBank<Under> under_;
  double time_ = 0.0;  ///< of the last segment's middle [s]
};

}  // namespace slipwise
