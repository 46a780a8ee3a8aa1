// SPDX-License-Identifier: Apache-2.0
// Least squares over slip terms: solution, named not_identifiable directions, and the two spread surfaces.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "slipwise/linear/cholesky.hpp"
#include "slipwise/thesis/least_squares_surface.hpp"

namespace slipwise {
namespace {

const std::vector<std::string> kTerms{"kappa", "V", "kappa*V", "kappa^2", "V^2"};

/// The thesis's terms (5.2) for speeds and curvatures.
Eigen::MatrixXd thesis_rows(const Eigen::MatrixX2d& drive) {
  Eigen::MatrixXd rows(drive.rows(), 5);
  for (Eigen::Index i = 0; i < drive.rows(); ++i) {
    const double v = drive(i, 0), kappa = drive(i, 1) / v;
    rows.row(i) << kappa, v, kappa * v, kappa * kappa, v * v;
  }
  return rows;
}

Eigen::MatrixX2d drives(Eigen::Index count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> speed(0.5, 3.0), yaw_rate(-1.0, 1.0);
  Eigen::MatrixX2d drive(count, 2);
  for (Eigen::Index i = 0; i < count; ++i) {
    drive.row(i) << speed(random), yaw_rate(random);
  }
  return drive;
}

TEST_CASE("full rank gives the weighted normal equations") {
  const Eigen::MatrixXd rows = thesis_rows(drives(60, 1));
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  const Eigen::VectorXd output = Eigen::VectorXd::NullaryExpr(60, [&] { return normal(random); });
  const Eigen::VectorXd std = Eigen::VectorXd::NullaryExpr(60, [](Eigen::Index i) { return i % 3 == 0 ? 2.0 : 1.0; });
  const LeastSquaresFit fit = fit_least_squares(rows, output, std);
  const Eigen::VectorXd weight = std.cwiseAbs2().cwiseInverse();
  const Eigen::MatrixXd normal_matrix = rows.transpose() * weight.asDiagonal() * rows;
  CHECK(fit.rank() == 5);
  CHECK(fit.coefficients.isApprox(
      Cholesky(normal_matrix).solve(Eigen::VectorXd(rows.transpose() * weight.cwiseProduct(output))), 1e-8));
  CHECK(fit.leverage.sum() == doctest::Approx(5.0));
  CHECK(undetermined_directions(fit, kTerms).empty());
}

TEST_CASE("straight drives leave each term of the curvature at zero") {
  Eigen::MatrixX2d drive = drives(30, 5);
  drive.col(1).setZero();
  const LeastSquaresFit fit = fit_least_squares(thesis_rows(drive), drive.col(0), Eigen::VectorXd::Ones(30));
  const std::vector<std::string> said = undetermined_directions(fit, kTerms);
  CHECK(said.size() == 3);
  for (const char* term : {"kappa", "kappa*V", "kappa^2"}) {
    CHECK(std::ranges::count(said, std::string(term) + " is zero in all examples") == 1);
  }
}

TEST_CASE("a channel without terms has no slip, and all of it is residual") {
  const Eigen::VectorXd output = Eigen::Vector3d(0.1, -0.2, 0.3);
  const LeastSquaresFit fit = fit_least_squares(Eigen::MatrixXd(3, 0), output, Eigen::VectorXd::Ones(3));
  CHECK(fit.coefficients.size() == 0);
  CHECK(fit.rank() == 0);
  CHECK(fit.residual == output);
  CHECK(fit.mean_variance(Eigen::VectorXd(0)) == 0.0);
  CHECK(thesis_std_coefficients(Eigen::MatrixXd(3, 0), fit).size() == 0);
}

TEST_CASE("wrong input is refused") {
  const Eigen::MatrixXd rows = Eigen::MatrixXd::Ones(3, 2);
  CHECK_THROWS_AS(fit_least_squares(rows, Eigen::VectorXd::Ones(2), Eigen::VectorXd::Ones(3)), std::invalid_argument);
  CHECK_THROWS_AS(fit_least_squares(rows, Eigen::VectorXd::Ones(3), Eigen::VectorXd::Zero(3)), std::invalid_argument);
  CHECK_THROWS_AS(fit_least_squares(std::nan("") * rows, Eigen::VectorXd::Ones(3), Eigen::VectorXd::Ones(3)),
                  std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
