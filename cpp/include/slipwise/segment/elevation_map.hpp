// SPDX-License-Identifier: Apache-2.0
// Elevations of the ground on a grid: its height and its rise anywhere, with derivatives.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "slipwise/linear/plain_value.hpp"

namespace slipwise {

/// How the ground rises somewhere.
template <class Scalar>
struct GroundRise {
  Scalar x, y;    ///< rise per metre along the axes [m/m]
  Scalar xx, xy;  ///< how the first changes along x and y [1/m]
  Scalar yx, yy;  ///< how the second does
};

/// Elevations at nodes. Between them heights are bilinear, and so is the rise, which at a node is the central
/// difference of its neighbours. Beyond the border all stays as it is there.
class ElevationMap {
 public:
  /// \param elevation [m], a row for each y, a column for each x. \param origin the first node (x, y) [m].
  /// \param cell distance between nodes [m].
  /// \throws std::invalid_argument when there are less than two rows or columns, a number is not finite, or the cell
  /// is not positive.
  ElevationMap(Eigen::MatrixXd elevation, Eigen::Vector2d origin, double cell);

  template <class Scalar>
  GroundRise<Scalar> rise(const Scalar& x, const Scalar& y) const {
    const auto along_x = bilinear(rise_x_, x, y);
    const auto along_y = bilinear(rise_y_, x, y);
    return {along_x.value, along_y.value, along_x.by_x, along_x.by_y, along_y.by_x, along_y.by_y};
  }
  /// [m]
  double height(double x, double y) const;
  /// Whether it has nodes around (x, y) [m].
  bool holds(double x, double y) const;

  /// What it is made of.
  std::tuple<Eigen::MatrixXd, Eigen::Vector2d, double> definition() const;

 private:
  template <class Scalar>
  struct Bilinear {
    Scalar value, by_x, by_y;
  };
  /// The cell before `places` [cells], and the fraction of it that lies before them, 0 or 1 beyond the border.
  template <class Scalar>
  struct Cell {
    Eigen::Index first;
    Scalar fraction;
    double inside;
  };
  template <class Scalar>
  Cell<Scalar> cell_of(const Scalar& metres, double origin, Eigen::Index nodes) const {
    const Scalar place = (metres - Scalar(origin)) / Scalar(cell_);
    const auto last = static_cast<double>(nodes - 1);
    if (!(value_of(place) > 0.0)) {
      return {0, Scalar(0.0), 0.0};
    }
    if (value_of(place) >= last) {
      return {nodes - 2, Scalar(1.0), 0.0};
    }
    const double first = std::floor(value_of(place));
    return {static_cast<Eigen::Index>(first), place - Scalar(first), 1.0};
  }
  template <class Scalar>
  Bilinear<Scalar> bilinear(const Eigen::MatrixXd& nodes, const Scalar& x, const Scalar& y) const {
    const auto col = cell_of(x, origin_.x(), nodes.cols());
    const auto row = cell_of(y, origin_.y(), nodes.rows());
    const auto block = nodes.block<2, 2>(row.first, col.first);
    const Scalar before = Scalar(block(0, 0)) + (Scalar(block(0, 1) - block(0, 0))) * col.fraction;
    const Scalar after = Scalar(block(1, 0)) + (Scalar(block(1, 1) - block(1, 0))) * col.fraction;
    const Scalar along = Scalar(block(0, 1) - block(0, 0)) * (Scalar(1.0) - row.fraction) +
                         Scalar(block(1, 1) - block(1, 0)) * row.fraction;
    return {before + (after - before) * row.fraction, along * Scalar(col.inside / cell_),
            (after - before) * Scalar(row.inside / cell_)};
  }

  Eigen::MatrixXd elevation_;
  Eigen::Vector2d origin_;
  double cell_;
  Eigen::MatrixXd rise_x_;
  Eigen::MatrixXd rise_y_;
};

}  // namespace slipwise
