// SPDX-License-Identifier: Apache-2.0
// A lumped force that acts on the robot, as states of a filter that come and go slowly: weak constraints of thesis
// 8.1.1 (derivations/slopes-and-forces.md).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slipwise/filter/estimate.hpp"
#include "slipwise/slip/basis.hpp"

namespace slipwise {

/// How large and how lasting a force may be: first-order Gauss-Markov processes.
struct BodyForceSettings {
  double time_constant = 0.0;  ///< [s]; 0: no force is learned
  double std = 0.03;           ///< of the drift that it causes along and across, per distance driven [m/m]
  double turn_std = 0.03;      ///< of the turn that it causes [rad/m]
  double arm = 3.0;            ///< distance whose drift is expected for a turn of one radian [m]
};

/// The states of a force among the parameters of a model. Terms that a basis happens to share with a force are those of
/// the force where one is learned.
class BodyForce {
 public:
  BodyForce() = default;  ///< none is learned
  /// \throws std::invalid_argument when a number of the law is negative or not finite.
  BodyForce(const Basis& basis, const BodyForceSettings& settings);

  bool learned() const { return !places_.empty(); }
  /// Of its states among the parameters; none where no force is learned.
  const std::vector<Eigen::Index>& places() const { return places_; }
  /// Standard deviations of slip, those of the force put to their own.
  Eigen::VectorXd prior_std(Eigen::VectorXd slip_std) const;
  /// The estimate after `seconds` without a measurement; where they are negative, another run has begun, and
  /// nothing is known of the force.
  void pass(Estimate& estimate, double seconds) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.time_constant_, self.places_, self.nominal_);
  }

 private:
  double time_constant_ = 0.0;
  std::vector<Eigen::Index> places_;
  Eigen::MatrixXd nominal_;  ///< covariance of the states before anything is known
};

}  // namespace slipwise
