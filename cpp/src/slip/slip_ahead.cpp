// SPDX-License-Identifier: Apache-2.0
// Parameters of slip amid a path over several surfaces.
#include "slipwise/slip/slip_ahead.hpp"

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace slipwise {

void check_ahead(const SlipAhead& ahead, Eigen::Index slip) {
  if (ahead.edges.size() > kMostEdges || ahead.changes.size() != ahead.edges.size()) {
    throw std::invalid_argument("slip ahead has " + std::to_string(ahead.edges.size()) + " edges and " +
                                std::to_string(ahead.changes.size()) + " changes; give as many of both, at most " +
                                std::to_string(kMostEdges));
  }
  double before = 0.0;
  for (std::size_t k = 0; k < ahead.edges.size(); ++k) {
    if (!(ahead.edges[k] > before) || !std::isfinite(ahead.edges[k])) {
      throw std::invalid_argument("the distances of edges ahead must increase from above zero");
    }
    before = ahead.edges[k];
    if (ahead.changes[k].size() != slip || !ahead.changes[k].allFinite()) {
      throw std::invalid_argument("a change of slip ahead needs " + std::to_string(slip) + " finite numbers, got " +
                                  std::to_string(ahead.changes[k].size()));
    }
  }
}

void move_slip(const Eigen::MatrixXd& direction, Eigen::VectorXd& parameters, SlipAhead& ahead) {
  if (direction.cols() > 0) {
    parameters.head(direction.rows()) += direction.col(0);
  }
  for (Eigen::Index k = 1; k < direction.cols(); ++k) {
    ahead.changes[static_cast<std::size_t>(k - 1)] += direction.col(k) - direction.col(k - 1);
  }
}

Eigen::VectorXd slip_over(const SlipAhead& ahead, const Eigen::Ref<const Eigen::VectorXd>& alpha, double travelled,
                          double length) {
  Eigen::VectorXd mean = alpha;
  for (std::size_t k = 0; k < ahead.edges.size(); ++k) {
    mean += fraction_beyond(ahead.edges[k], travelled, length) * ahead.changes[k];
  }
  return mean;
}

}  // namespace slipwise
