// SPDX-License-Identifier: Apache-2.0
// Slip that becomes another at distances along the path, where the robot comes to another surface
// (derivations/surfaces.md).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "slipwise/slip/path_edges.hpp"

namespace slipwise {

/// The parameters of slip along a path. Distances are what the robot has moved ahead or back since its start.
struct SlipAhead {
  std::vector<double> edges;             ///< [m], increasing and positive
  std::vector<Eigen::VectorXd> changes;  ///< [slip] of each edge: what is added to the parameters before it

  bool empty() const { return edges.empty(); }
};

/// \throws std::invalid_argument when there are too many edges, they do not increase from above zero, or a change does
/// not fit the `slip` parameters of a model.
void check_ahead(const SlipAhead& ahead, Eigen::Index slip);

/// Moves the slip of all stretches along a `direction` [slip, stretches], which may have no columns: that of the first
/// is the head of `parameters`.
void move_slip(const Eigen::MatrixXd& direction, Eigen::VectorXd& parameters, SlipAhead& ahead);

/// Which fraction of a step of `length` [m], from `travelled` [m] on, lies beyond an edge.
inline double fraction_beyond(double edge, double travelled, double length) {
  const double step = length + kEdgeWidth;
  return std::clamp((travelled + step - edge) / step, 0.0, 1.0);
}

/// The parameters over a step: the mean of those of the surfaces that it is driven on.
Eigen::VectorXd slip_over(const SlipAhead& ahead, const Eigen::Ref<const Eigen::VectorXd>& alpha, double travelled,
                          double length);

}  // namespace slipwise
