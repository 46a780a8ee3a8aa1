// SPDX-License-Identifier: Apache-2.0
// Pools what several experts say into one calibrated probability, and judges whether a surface is unknown.
#pragma once

#include <Eigen/Core>

namespace slipwise {

/// Exponents of the experts in a logarithmic pool, and the weights of the signs of an unknown surface.
struct ExpertPool {
  double vibration = 0.0;  ///< exponent; 0 where the expert is not asked
  double current = 0.0;
  double offset = 0.0;
  double doubt = 0.0;    ///< weight of the log odds against the most probable surface
  double newness = 0.0;  ///< weight of the distance to what was trained

  /// The pooled probabilities [N, K]; an expert whose exponent is 0 may hold anything.
  /// \throws std::invalid_argument when the experts differ in shape.
  Eigen::MatrixXd pooled(const Eigen::Ref<const Eigen::MatrixXd>& by_vibration,
                         const Eigen::Ref<const Eigen::MatrixXd>& by_current) const;
  /// P(unknown) [N] with even prior odds, from pooled probabilities [N, K] and the newness
  /// [N] of the vibration's expert.
  Eigen::VectorXd unknown(const Eigen::Ref<const Eigen::MatrixXd>& probability,
                          const Eigen::Ref<const Eigen::VectorXd>& newness_of) const;
};

/// The log odds against the most probable surface, [N], of probabilities [N, K].
Eigen::VectorXd doubt_of(const Eigen::Ref<const Eigen::MatrixXd>& probability);

}  // namespace slipwise
