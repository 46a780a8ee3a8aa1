// SPDX-License-Identifier: Apache-2.0
// Elevations are checked once, and their rise at the nodes is found once.
#include "slipwise/segment/elevation_map.hpp"

#include <stdexcept>
#include <utility>

namespace slipwise {
namespace {

/// Central differences from row to row, and one-sided ones at the border [m/m].
Eigen::MatrixXd difference_of_rows(const Eigen::MatrixXd& nodes, double cell) {
  const Eigen::Index last = nodes.rows() - 1;
  Eigen::MatrixXd rise(nodes.rows(), nodes.cols());
  for (Eigen::Index i = 0; i <= last; ++i) {
    const Eigen::Index before = std::max<Eigen::Index>(i - 1, 0);
    const Eigen::Index after = std::min(i + 1, last);
    rise.row(i) = (nodes.row(after) - nodes.row(before)) / (static_cast<double>(after - before) * cell);
  }
  return rise;
}

}  // namespace

ElevationMap::ElevationMap(Eigen::MatrixXd elevation, Eigen::Vector2d origin, double cell)
    : elevation_(std::move(elevation)), origin_(std::move(origin)), cell_(cell) {
  if (elevation_.rows() < 2 || elevation_.cols() < 2) {
    throw std::invalid_argument("an elevation map has two rows and two columns of nodes at least");
  }
  if (!elevation_.allFinite() || !origin_.allFinite()) {
    throw std::invalid_argument("an elevation map is finite everywhere; fill its holes first");
  }
  if (!(cell > 0.0) || !std::isfinite(cell)) {
    throw std::invalid_argument("the nodes of an elevation map are a positive distance apart [m]");
  }
  rise_y_ = difference_of_rows(elevation_, cell);
  rise_x_ = difference_of_rows(elevation_.transpose(), cell).transpose();
}

double ElevationMap::height(double x, double y) const { return bilinear(elevation_, x, y).value; }

std::tuple<Eigen::MatrixXd, Eigen::Vector2d, double> ElevationMap::definition() const {
  return {elevation_, origin_, cell_};
}

bool ElevationMap::holds(double x, double y) const {
  const double column = (x - origin_.x()) / cell_;
  const double row = (y - origin_.y()) / cell_;
  return column >= 0.0 && row >= 0.0 && column <= static_cast<double>(elevation_.cols() - 1) &&
         row <= static_cast<double>(elevation_.rows() - 1);
}

}  // namespace slipwise
