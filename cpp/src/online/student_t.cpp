// SPDX-License-Identifier: Apache-2.0
// The radial distribution of a Student t in three dimensions by quadrature.
#include "slipwise/online/student_t.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace slipwise {
namespace {

constexpr std::size_t kNodes = 64;

/// Nodes and weights of Gauss and Legendre's quadrature on [-1, 1].
struct GaussLegendre {
  std::array<double, kNodes> node{};
  std::array<double, kNodes> weight{};

  GaussLegendre() {
    constexpr double n = kNodes;
    for (std::size_t i = 0; i < kNodes; ++i) {
      double x = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) / (n + 0.5));
      double derivative = 0.0;
      for (int iteration = 0; iteration < 10; ++iteration) {  // Newton's; five are enough
        double before = 1.0;
        double now = x;
        for (std::size_t k = 2; k <= kNodes; ++k) {  // Legendre's recursion
          const auto order = static_cast<double>(k);
          const double next = ((2.0 * order - 1.0) * x * now - (order - 1.0) * before) / order;
          before = now;
          now = next;
        }
        derivative = n * (x * now - before) / (x * x - 1.0);
        x -= now / derivative;
      }
      node[i] = x;
      weight[i] = 2.0 / ((1.0 - x * x) * derivative * derivative);
    }
  }
};

}  // namespace

/// With a radius of sqrt(dof) tan(a) in the scale matrix, the density over a is sin(a)^2 cos(a)^(dof - 1), up to a
/// constant; the quadrature is exact to 1e-12 between the least and the most degrees of freedom.
double fraction_inside(double squared, double dof) {
  static const GaussLegendre rule;
  const double half = 0.5 * std::atan(std::sqrt(squared / (dof - 2.0)));
  double sum = 0.0;
  for (std::size_t i = 0; i < kNodes; ++i) {
    const double angle = half * (1.0 + rule.node[i]);
    sum += rule.weight[i] * std::pow(std::sin(angle), 2) * std::pow(std::cos(angle), dof - 1.0);
  }
  const double whole = std::exp(std::lgamma(1.5) + std::lgamma(dof / 2.0) - std::lgamma((dof + 3.0) / 2.0));
  return std::min(2.0 * half * sum / whole, 1.0);
}

}  // namespace slipwise
