// SPDX-License-Identifier: Apache-2.0
// Least squares over terms (thesis 5.5) that says what it cannot determine, and the spread of the residuals.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace slipwise {

struct LeastSquaresFit {
  Eigen::VectorXd coefficients;  ///< [d], the smallest in units of the columns where not all are determined
  Eigen::MatrixXd covariance;    ///< [d, d] within the determined directions, from the residuals
  Eigen::MatrixXd
      not_identifiable;      ///< [d, d - rank]: directions that no example tells of, sparse, in units of the columns
  Eigen::VectorXd scale;     ///< [d] root mean square of each column; 1 where it is zero
  Eigen::VectorXd residual;  ///< [n] output minus fit
  Eigen::VectorXd leverage;  ///< [n] fraction of each example in its own fit, 0..1

  Eigen::Index rank() const { return coefficients.size() - not_identifiable.cols(); }
  /// Variance of the fitted mean at one state; infinite where the features leave the determined directions.
  double mean_variance(const Eigen::Ref<const Eigen::VectorXd>& features) const;
};

/// Minimises sum(((y - X c) / relative_std)^2). \param design X [n, d] \param output y [n] \param relative_std [n]
/// \throws std::invalid_argument when sizes differ, there is no example, or a number is not finite.
LeastSquaresFit fit_least_squares(const Eigen::Ref<const Eigen::MatrixXd>& design,
                                  const Eigen::Ref<const Eigen::VectorXd>& output,
                                  const Eigen::Ref<const Eigen::VectorXd>& relative_std);

/// The not_identifiable directions in words: "V and V^2 cannot be distinguished", "w is zero in all examples".
std::vector<std::string> undetermined_directions(const LeastSquaresFit& fit, std::span<const std::string> terms);

/// Thesis (5.6-5.8): |r| regressed on the same terms. It reads 20 % low, and can be negative.
Eigen::VectorXd thesis_std_coefficients(const Eigen::Ref<const Eigen::MatrixXd>& design, const LeastSquaresFit& fit);

/// E[log chi^2_1] = -(log 2 + Euler's constant): what log r^2 reads low by.
inline constexpr double kMeanLogChiSquare = -1.2703628454614782;

/// log(variance) = coefficients . (1, |V| / v_ref, |omega| / omega_ref).
struct LogVarianceFit {
  Eigen::Vector3d coefficients;
  double v_ref;      ///< [m/s]
  double omega_ref;  ///< [rad/s]

  double std(double v, double omega) const;
};

/// Regresses log r^2, corrected for its bias and for leverage, on speed and yaw rate, with a prior of one per
/// derivative.
/// \param drive (V, omega) [n, 2] \throws std::invalid_argument when sizes differ.
LogVarianceFit fit_log_variance(const Eigen::Ref<const Eigen::MatrixX2d>& drive, const LeastSquaresFit& fit);

}  // namespace slipwise
