// SPDX-License-Identifier: Apache-2.0
// Least squares by QR and singular values of scaled columns, with named null directions.
#include "slipwise/thesis/least_squares_surface.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "slipwise/thesis/bayesian_regression.hpp"

namespace slipwise {
namespace {

constexpr double kRankTolerance = 1e-9;  // of the largest singular value of the scaled columns
constexpr double kShown = 1e-6;          // a smaller fraction of a direction is rounding
constexpr double kLeastFraction = 1e-6;  // of the mean r^2; log r^2 of an exact hit is taken as this
constexpr double kFloor = 1e-12;         // of a standard deviation and of a reference speed
constexpr double kSlopeStd = 1.0;        // prior of a slope of log variance per reference speed
constexpr double kLevelStd = 10.0;       // prior of its level about the mean r^2

/// The same space by directions that hold as few terms as possible (reduced column echelon form, largest pivots).
Eigen::MatrixXd sparse_directions(Eigen::MatrixXd space) {
  for (Eigen::Index k = 0; k < space.cols(); ++k) {
    Eigen::Index row = 0, column = 0;
    space.rightCols(space.cols() - k).cwiseAbs().maxCoeff(&row, &column);
    space.col(k).swap(space.col(k + column));
    space.col(k) /= space(row, k);
    for (Eigen::Index other = 0; other < space.cols(); ++other) {
      if (other != k) {
        space.col(other) -= space(row, other) * space.col(k);
      }
    }
  }
  space = (space.array().abs() < kShown).select(0.0, space);
  space.colwise().normalize();
  return space;
}

Eigen::VectorXd column_scale(const Eigen::MatrixXd& design) {
  const Eigen::VectorXd scale = (design.colwise().squaredNorm() / static_cast<double>(design.rows())).cwiseSqrt();
  return (scale.array() > kFloor).select(scale, 1.0);
}

/// A = U diag(values) V^T, the values in falling order.
struct SingularValues {
  Eigen::MatrixXd u;  ///< [rows, columns]
  Eigen::VectorXd values;
  Eigen::MatrixXd v;  ///< [columns, columns]
};

/// By QR first, since designs are tall: A = Q R, and R is small. Rows of zeros make a flat design square.
SingularValues singular_values(const Eigen::MatrixXd& design) {
  const Eigen::Index n = design.cols(), rows = std::max(design.rows(), n);
  Eigen::MatrixXd padded = Eigen::MatrixXd::Zero(rows, n);
  padded.topRows(design.rows()) = design;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(padded);
  const Eigen::MatrixXd r = qr.matrixQR().topRows(n).triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::NoQRPreconditioner> svd(r, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(rows, n);
  u.topRows(n) = svd.matrixU();
  u.applyOnTheLeft(qr.householderQ());
  return {u.topRows(design.rows()), svd.singularValues(), svd.matrixV()};
}

void check(const Eigen::Ref<const Eigen::MatrixXd>& design, const Eigen::Ref<const Eigen::VectorXd>& output,
           const Eigen::Ref<const Eigen::VectorXd>& relative_std) {
  if (design.rows() == 0 || output.size() != design.rows() || relative_std.size() != design.rows()) {
    throw std::invalid_argument("least squares needs an output and a standard deviation for each of its rows");
  }
  if (!design.allFinite() || !output.allFinite() || !relative_std.allFinite() || !(relative_std.array() > 0.0).all()) {
    throw std::invalid_argument("least squares needs finite examples with positive standard deviations");
  }
}

}  // namespace

double LeastSquaresFit::mean_variance(const Eigen::Ref<const Eigen::VectorXd>& features) const {
  const Eigen::VectorXd scaled = features.cwiseQuotient(scale);
  if (not_identifiable.cols() > 0 && (not_identifiable.transpose() * scaled).norm() > kShown * (1.0 + scaled.norm())) {
    return std::numeric_limits<double>::infinity();
  }
  return std::max(features.dot(covariance * features), 0.0);
}

LeastSquaresFit fit_least_squares(const Eigen::Ref<const Eigen::MatrixXd>& design,
                                  const Eigen::Ref<const Eigen::VectorXd>& output,
                                  const Eigen::Ref<const Eigen::VectorXd>& relative_std) {
  check(design, output, relative_std);
  if (design.cols() == 0) {  // a channel without terms: nothing to fit, all is residual
    return {.coefficients = Eigen::VectorXd(0),
            .covariance = Eigen::MatrixXd(0, 0),
            .not_identifiable = Eigen::MatrixXd(0, 0),
            .scale = Eigen::VectorXd(0),
            .residual = output,
            .leverage = Eigen::VectorXd::Zero(output.size())};
  }
  const Eigen::VectorXd weight = relative_std.cwiseInverse();
  const Eigen::VectorXd scale = column_scale(design);
  const Eigen::MatrixXd scaled = weight.asDiagonal() * design * scale.cwiseInverse().asDiagonal();
  const SingularValues svd = singular_values(scaled);
  const double limit = std::max(kRankTolerance * svd.values[0], kFloor);
  const Eigen::Index rank = (svd.values.array() > limit).count();
  const Eigen::MatrixXd u = svd.u.leftCols(rank);
  const Eigen::MatrixXd v = scale.cwiseInverse().asDiagonal() * svd.v.leftCols(rank);
  const Eigen::VectorXd inverse = svd.values.head(rank).cwiseInverse();

  LeastSquaresFit fit;
  fit.scale = scale;
  fit.coefficients = v * (inverse.asDiagonal() * (u.transpose() * weight.cwiseProduct(output)));
  fit.not_identifiable = sparse_directions(svd.v.rightCols(design.cols() - rank));
  fit.residual = output - design * fit.coefficients;
  fit.leverage = u.rowwise().squaredNorm();
  const double left = static_cast<double>(std::max<Eigen::Index>(design.rows() - rank, 1));
  const double variance = fit.residual.cwiseProduct(weight).squaredNorm() / left;
  fit.covariance = variance * v * inverse.cwiseAbs2().asDiagonal() * v.transpose();
  return fit;
}

std::vector<std::string> undetermined_directions(const LeastSquaresFit& fit, std::span<const std::string> terms) {
  if (static_cast<Eigen::Index>(terms.size()) != fit.coefficients.size()) {
    throw std::invalid_argument("one name per coefficient is needed");
  }
  std::vector<std::string> result;
  for (const auto& direction : fit.not_identifiable.colwise()) {
    std::vector<std::string> named;
    for (Eigen::Index i = 0; i < direction.size(); ++i) {
      if (std::abs(direction[i]) > kShown) {
        named.push_back(terms[static_cast<std::size_t>(i)]);
      }
    }
    std::string text = named.empty() ? std::string() : named[0];
    for (std::size_t i = 1; i < named.size(); ++i) {
      text += (i + 1 == named.size() ? " and " : ", ") + named[i];
    }
    result.push_back(text + (named.size() > 1 ? " cannot be distinguished" : " is zero in all examples"));
  }
  return result;
}

Eigen::VectorXd thesis_std_coefficients(const Eigen::Ref<const Eigen::MatrixXd>& design, const LeastSquaresFit& fit) {
  const Eigen::VectorXd size = fit.residual.cwiseAbs();
  return fit_least_squares(design, size, Eigen::VectorXd::Ones(size.size())).coefficients;
}

double LogVarianceFit::std(double v, double omega) const {
  const Eigen::Vector3d features(1.0, std::abs(v) / v_ref, std::abs(omega) / omega_ref);
  return std::exp(0.5 * coefficients.dot(features));
}

LogVarianceFit fit_log_variance(const Eigen::Ref<const Eigen::MatrixX2d>& drive, const LeastSquaresFit& fit) {
  if (drive.rows() != fit.residual.size()) {
    throw std::invalid_argument("log variance needs one residual per (V, omega)");
  }
  const auto fraction_left = (1.0 - fit.leverage.array()).max(1.0 / static_cast<double>(drive.rows() + 1));
  const Eigen::ArrayXd square = fit.residual.array().square() / fraction_left;
  const double mean_square = std::max(square.mean(), kFloor * kFloor);
  const Eigen::ArrayXd log_square = (square / mean_square).max(kLeastFraction).log() - kMeanLogChiSquare;
  LogVarianceFit result{.coefficients = {},
                        .v_ref = std::max(drive.col(0).cwiseAbs().maxCoeff(), kFloor),
                        .omega_ref = std::max(drive.col(1).cwiseAbs().maxCoeff(), kFloor)};
  // log chi^2_1 has the variance pi^2 / 2.
  BayesianRegression regression({.weight_std = Eigen::Vector3d(kLevelStd, kSlopeStd, kSlopeStd),
                                 .noise_std = std::numbers::pi / std::numbers::sqrt2});
  for (Eigen::Index i = 0; i < drive.rows(); ++i) {
    regression.add({.features = Eigen::Vector3d(1.0, std::abs(drive(i, 0)) / result.v_ref,
                                                std::abs(drive(i, 1)) / result.omega_ref),
                    .output = log_square[i]});
  }
  result.coefficients = regression.mean();
  result.coefficients[0] += std::log(mean_square);
  return result;
}

}  // namespace slipwise
