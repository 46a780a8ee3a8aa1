// SPDX-License-Identifier: Apache-2.0
// Unknowns enter one by one where that lowers the cost, and leave where the solution would turn negative.
#include "slipwise/linear/nonnegative.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "slipwise/linear/cholesky.hpp"

namespace slipwise {
namespace {

/// The minimum over the unknowns in `free`; the others are zero.
Eigen::VectorXd restricted_solution(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                                    const std::vector<Eigen::Index>& free) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
  if (!free.empty()) {
    const Eigen::MatrixXd matrix = a(free, free);
    const Eigen::VectorXd vector = b(free);
    const Eigen::VectorXd solution = Cholesky(matrix).solve(vector);
    x(free) = solution;
  }
  return x;
}

/// Moves from x towards `target` until an unknown reaches zero, and drops those at zero from `free`.
void step_to_border(Eigen::VectorXd& x, const Eigen::VectorXd& target, std::vector<Eigen::Index>& free) {
  double length = 1.0;
  Eigen::Index first = free.front();
  for (const Eigen::Index i : free) {
    if (target[i] <= 0.0 && x[i] / (x[i] - target[i]) < length) {
      length = x[i] / (x[i] - target[i]);
      first = i;
    }
  }
  x += length * (target - x);
  x[first] = 0.0;
  std::erase_if(free, [&](Eigen::Index i) { return x[i] <= 0.0; });
}

}  // namespace

Eigen::VectorXd nonnegative_solution(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, const Eigen::VectorXd& near) {
  if (a.rows() != b.size() || a.cols() != b.size() || near.size() != b.size() || !Cholesky(a).positive_definite()) {
    throw std::invalid_argument("non-negative least squares needs a positive definite matrix of the vector's size");
  }
  // Unit diagonal: variances of metres and of radians differ by orders of magnitude.
  const Eigen::VectorXd scale = a.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * a * scale.asDiagonal();
  const Eigen::VectorXd target = scale.asDiagonal() * b;
  const double tolerance = 1e-12 * std::max(target.lpNorm<Eigen::Infinity>(), 1e-300);
  Eigen::VectorXd x = near.cwiseMax(0.0).cwiseQuotient(scale);
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (x[i] > 0.0) {
      free.push_back(i);
    }
  }
  const auto solve_free = [&] {
    Eigen::VectorXd next = restricted_solution(scaled, target, free);
    while (std::ranges::any_of(free, [&](Eigen::Index i) { return next[i] <= 0.0; })) {
      step_to_border(x, next, free);
      next = restricted_solution(scaled, target, free);
    }
    x = next;
  };
  solve_free();
  for (Eigen::Index round = 0; round < 3 * b.size(); ++round) {
    Eigen::VectorXd downhill = target - scaled * x;
    for (const Eigen::Index i : free) {
      downhill[i] = 0.0;
    }
    Eigen::Index enter = 0;
    if (downhill.maxCoeff(&enter) <= tolerance) {
      break;
    }
    free.push_back(enter);
    solve_free();
  }
  return scale.asDiagonal() * x;
}

}  // namespace slipwise
