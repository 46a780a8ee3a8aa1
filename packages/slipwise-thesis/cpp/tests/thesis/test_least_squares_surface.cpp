// SPDX-License-Identifier: Apache-2.0
// Least squares over slip terms: solution, named not_identifiable directions, and the two spread surfaces.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

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
  CHECK(fit.coefficients.isApprox(normal_matrix.inverse() * rows.transpose() * weight.cwiseProduct(output), 1e-8));
  CHECK(fit.leverage.sum() == doctest::Approx(5.0));
  CHECK(undetermined_directions(fit, kTerms).empty());
}

TEST_CASE("one speed leaves named pairs of terms apart by nothing") {
  Eigen::MatrixX2d drive = drives(30, 3);
  drive.col(0).setConstant(1.5);
  const Eigen::MatrixXd rows = thesis_rows(drive);
  const Eigen::VectorXd output = 0.1 * rows.col(1) + 0.2 * rows.col(2);
  const LeastSquaresFit fit = fit_least_squares(rows, output, Eigen::VectorXd::Ones(30));
  CHECK(fit.rank() == 3);
  CHECK(fit.residual.norm() < 1e-12);
  const std::vector<std::string> said = undetermined_directions(fit, kTerms);
  CHECK(said.size() == 2);
  CHECK(std::ranges::count(said, "V and V^2 cannot be distinguished") == 1);
  CHECK(std::ranges::count(said, "kappa and kappa*V cannot be distinguished") == 1);
  CHECK(std::isfinite(fit.mean_variance(rows.row(0).transpose())));
  CHECK(std::isinf(fit.mean_variance(thesis_rows(drives(1, 4)).row(0).transpose())));
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

TEST_CASE("the thesis's spread reads a fifth low; the log variance does not") {
  const Eigen::Index count = 20000;
  const Eigen::MatrixX2d drive = drives(count, 6);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  // A spread in proportion to speed, so that both forms can hold it near one place.
  const Eigen::VectorXd output = drive.col(0).unaryExpr([&](double v) { return 0.05 * v * normal(random); });
  const Eigen::MatrixXd rows = thesis_rows(drive);
  const LeastSquaresFit fit = fit_least_squares(rows, output, Eigen::VectorXd::Ones(count));
  const Eigen::VectorXd s = thesis_std_coefficients(rows, fit);
  const Eigen::MatrixX2d place = (Eigen::MatrixX2d(1, 2) << 1.75, 0.0).finished();
  const double truth = 0.05 * 1.75;
  CHECK((thesis_rows(place) * s).value() / truth == doctest::Approx(std::sqrt(2.0 / std::acos(-1.0))).epsilon(0.03));
  const LogVarianceFit log_variance = fit_log_variance(drive, fit);
  CHECK(log_variance.std(1.75, 0.0) / truth == doctest::Approx(1.0).epsilon(0.12));  // exp(V) for V
}

TEST_CASE("a spread that is constant is recovered by the log variance within three sigma") {
  const Eigen::Index count = 4000;
  const Eigen::MatrixX2d drive = drives(count, 8);
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  const Eigen::VectorXd output = Eigen::VectorXd::NullaryExpr(count, [&] { return 0.2 * normal(random); });
  const LogVarianceFit fit =
      fit_log_variance(drive, fit_least_squares(thesis_rows(drive), output, Eigen::VectorXd::Ones(count)));
  // One log r^2 has the standard deviation 2.22: near the middle of the drives, half of it over the root of 4000.
  CHECK(std::log(fit.std(1.75, 0.5) / 0.2) == doctest::Approx(0.0).scale(1.0).epsilon(3.0 * 1.11 / std::sqrt(4000.0)));
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
