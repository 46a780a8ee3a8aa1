// SPDX-License-Identifier: Apache-2.0
// Both objectives are linear in the variances: normal equations with different weights, solved for x >= 0.
#include "slipwise/thesis/noise_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/nonnegative.hpp"
#include "slipwise/linear/symmetric_eigen.hpp"

namespace slipwise {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kDefinite = 1e-9;     // least eigenvalue of a correlation matrix of full rank
constexpr double kDistinct = 1e-10;    // least eigenvalue of the scaled normal equations
constexpr double kWeightFloor = 1e-4;  // of the first guess: weights never trust a noise that is exactly zero

/// What one group says: its scatter, less the known pose noise, and the parts that shall add up to it.
struct GroupScatter {
  Eigen::MatrixXd observed;  ///< scatter
  Eigen::VectorXd known;     ///< diagonal of the pose noise
  std::array<Eigen::MatrixXd, 6> parts;
  double freedom;  ///< segments - 1
  double last;     ///< time [s]

  Eigen::MatrixXd expected(const Vector6& noise) const {
    Eigen::MatrixXd sum = known.asDiagonal();
    for (Eigen::Index i = 0; i < 6; ++i) {
      sum += noise[i] * parts[static_cast<std::size_t>(i)];
    }
    return sum;
  }
};

/// Test matrices N_i: the normal equations are sum tr(N_i M_j) x_j = sum tr(N_i scatter).
std::array<Eigen::MatrixXd, 6> test_matrices(const GroupScatter& group, const Eigen::MatrixXd& expected,
                                             NoiseObjective objective) {
  std::array<Eigen::MatrixXd, 6> tests;
  if (objective == NoiseObjective::Fisher) {
    const Cholesky factor(expected);
    for (std::size_t i = 0; i < 6; ++i) {
      const Eigen::MatrixXd half = factor.solve(group.parts[i]);
      tests[i] = 0.5 * group.freedom * factor.solve(half.transpose());
    }
    return tests;
  }
  for (std::size_t i = 0; i < 6; ++i) {  // (4.13): six entries of each time's matrix, each once
    tests[i] = Eigen::MatrixXd::Zero(expected.rows(), expected.cols());
    for (Eigen::Index k = 0; k < expected.rows(); k += 3) {
      const Eigen::Matrix3d block = group.parts[i].block<3, 3>(k, k);
      const Eigen::Matrix3d diagonal = block.diagonal().asDiagonal();
      tests[i].block<3, 3>(k, k) = 0.5 * (block + diagonal);
    }
  }
  return tests;
}

struct ScatterEquations {
  Matrix6 matrix = Matrix6::Zero();
  Vector6 vector = Vector6::Zero();
  Matrix6 spread = Matrix6::Zero();  ///< covariance of `vector` under the expected scatter
};

double trace_of_product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.cwiseProduct(b.transpose()).sum();
}

void add_group(ScatterEquations& equations, const GroupScatter& group, const Vector6& noise, NoiseObjective objective) {
  const Eigen::MatrixXd expected = group.expected(noise);
  const auto tests = test_matrices(group, expected, objective);
  const Eigen::MatrixXd unexplained = group.observed - Eigen::MatrixXd(group.known.asDiagonal());
  for (std::size_t i = 0; i < 6; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const Eigen::MatrixXd observed = expected * tests[i] * expected;
    equations.vector[row] += trace_of_product(tests[i], unexplained);
    for (std::size_t j = 0; j < 6; ++j) {
      const auto column = static_cast<Eigen::Index>(j);
      equations.matrix(row, column) += trace_of_product(tests[i], group.parts[j]);
      // Cov(r_i r_j, r_k r_l) = S_ik S_jl + S_il S_jk, averaged over the segments
      equations.spread(row, column) += 2.0 / group.freedom * trace_of_product(observed, tests[j]);
    }
  }
}

ScatterEquations normal_equations(std::span<const GroupScatter> groups, const Vector6& noise,
                                  NoiseObjective objective) {
  ScatterEquations equations;
  for (const GroupScatter& group : groups) {
    add_group(equations, group, noise, objective);
  }
  const Vector6 scale = equations.matrix.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix6 scaled = scale.asDiagonal() * equations.matrix * scale.asDiagonal();
  if (!scaled.allFinite() || symmetric_eigen(scaled).values[0] < kDistinct) {
    throw std::invalid_argument(
        "slip noise and start uncertainty cannot be distinguished; give at least two times, far from each other");
  }
  return equations;
}

bool has_rank_three(const Eigen::MatrixXd& scatter) {
  for (Eigen::Index k = 0; k < scatter.rows(); k += 3) {
    const Eigen::Matrix3d block = scatter.block<3, 3>(k, k);
    const Eigen::Vector3d scale = block.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::Matrix3d correlation = scale.asDiagonal() * block * scale.asDiagonal();
    if (!correlation.allFinite() || symmetric_eigen(correlation).values[0] < kDefinite) {
      return false;
    }
  }
  return true;
}

GroupScatter scatter_of(const NoiseGroup& group, const NoiseFitSettings& settings) {
  GroupScatter result{.observed = scatter_matrix(group, settings.centre),
                      .known = settings.pose.replicate(static_cast<Eigen::Index>(group.times.size()), 1),
                      .parts = steady_covariance_parts(group.twist, group.times),
                      .freedom = static_cast<double>(group.residuals.size()) - 1.0,
                      .last = group.times.back()};
  if (!(result.observed.diagonal().tail<3>().minCoeff() > 0.0)) {
    throw std::invalid_argument(
        "the segments of a group do not scatter at all in x, y or heading; look for duplicates");
  }
  return result;
}

/// Half of the first time's scatter for the start, half of the growth for the slip rates; never zero.
Vector6 first_guess(std::span<const GroupScatter> groups) {
  Vector6 guess = Vector6::Zero();
  for (const GroupScatter& group : groups) {
    const Eigen::Vector3d end = group.observed.diagonal().tail<3>();
    guess.head<3>() += 0.5 * end / group.last;
    guess.tail<3>() += 0.5 * group.observed.diagonal().head<3>() + 1e-3 * end;
  }
  return guess / static_cast<double>(groups.size());
}

Matrix6 covariance_of(const ScatterEquations& at) {
  const Matrix6 inverse = Cholesky(at.matrix).inverse();
  return inverse * at.spread * inverse;  // for Fisher scoring, spread = matrix
}

}  // namespace

Eigen::MatrixXd scatter_matrix(const NoiseGroup& group, ScatterCentre centre) {
  if (group.residuals.size() < 3) {
    throw std::invalid_argument("a scatter needs at least three segments of a group, got " +
                                std::to_string(group.residuals.size()) +
                                ": one residual's outer product has rank 1 (the thesis says that one is enough)");
  }
  const auto count = static_cast<Eigen::Index>(group.times.size());
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(3 * count);
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(3 * count, 3 * count);
  for (const Eigen::Matrix3Xd& residual : group.residuals) {
    if (count == 0 || residual.cols() != count || !residual.allFinite()) {
      throw std::invalid_argument("every segment needs one finite residual for each of the group's times");
    }
    sum += residual.reshaped();
  }
  const auto n = static_cast<double>(group.residuals.size());
  if (centre == ScatterCentre::Curve) {
    sum.setZero();
  }
  for (const Eigen::Matrix3Xd& residual : group.residuals) {
    const Eigen::VectorXd deviation = residual.reshaped() - sum / n;
    squares += deviation * deviation.transpose();
  }
  return squares / (n - 1.0);
}

NoiseFit fit_noise(std::span<const NoiseGroup> groups, const NoiseFitSettings& settings) {
  if (groups.empty()) {
    throw std::invalid_argument("a noise fit needs at least one group of segments");
  }
  NoiseFit fit{{}, Matrix6::Zero(), true, 0, Status::NotConverged};
  std::vector<GroupScatter> scatters;
  for (const NoiseGroup& group : groups) {
    scatters.push_back(scatter_of(group, settings));
    fit.scatter_definite = fit.scatter_definite && has_rank_three(scatters.back().observed);
  }
  const Vector6 guess = first_guess(scatters);
  Vector6 noise = guess;
  const auto weights_at = [&](const Vector6& at) { return at.cwiseMax(kWeightFloor * guess).eval(); };
  while (fit.iterations < settings.iterations && fit.status == Status::NotConverged) {
    ++fit.iterations;
    const auto equations = normal_equations(scatters, weights_at(noise), settings.objective);
    const Vector6 next = nonnegative_solution(equations.matrix, equations.vector, noise);
    const Vector6 std = covariance_of(equations).diagonal().cwiseSqrt();
    const bool settled = ((next - noise).array().abs() <= settings.tolerance * std.array()).all();
    fit.status = settled || settings.objective == NoiseObjective::Thesis ? Status::Converged : fit.status;
    noise = next;
  }
  fit.covariance = covariance_of(normal_equations(scatters, weights_at(noise), settings.objective));
  fit.noise = {.psd = noise.head<3>(), .start = noise.tail<3>(), .pose = settings.pose};
  return fit;
}

}  // namespace slipwise
