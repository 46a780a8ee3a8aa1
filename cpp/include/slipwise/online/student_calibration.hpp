// SPDX-License-Identifier: Apache-2.0
// How large and how heavy-tailed the errors of predictions are, beside what their covariance said.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <type_traits>

namespace slipwise {

/// A multivariate Student t around a prediction.
struct StudentT {
  double inflation;  ///< factor of the covariance
  double dof;        ///< degrees of freedom
};

/// Weights over a part of a grid, beside which the rest is negligible; they sum to 1.
struct GridWeights {
  Eigen::Index first = 0;
  Eigen::VectorXd weights;
  double log_sum = 0.0;  ///< logarithm of the sum before that was so
};

/// Fits a Student t to the errors of predictions, one after another. The posterior over a grid of variance scale and
/// degrees of freedom is a mixture of t; the t reported is the one with the mixture's 50 % and 95 % ellipsoids. How
/// fast older errors are forgotten is weighted by how well each forgetting time predicted the errors so far
/// (derivations/uncertainty.md).
class StudentCalibration {
 public:
  StudentCalibration();
  /// Takes in the squared Mahalanobis length of an error in its reported covariance.
  void learn(double squared);
  StudentT fitted() const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.evidence_, self.predicted_);
    self.check_sizes();
    if constexpr (!std::is_const_v<Self>) {
      self.weigh();
    }
  }

 private:
  /// \throws std::invalid_argument unless there is evidence for each place of the grid.
  void check_sizes() const;
  /// Finds the posteriors of the evidence, which are not saved.
  void weigh();

  static constexpr std::size_t kForgettingTimes = 4;
  std::array<Eigen::VectorXd, kForgettingTimes> evidence_;  ///< over the grid, logarithms
  std::array<GridWeights, kForgettingTimes> posterior_;
  std::array<double, kForgettingTimes> predicted_{};  ///< log densities of all errors so far
};

}  // namespace slipwise
