// SPDX-License-Identifier: Apache-2.0
// The mean ratio of the rows of each sensor of positions.
#include "slipwise/filter/rows_of_positions.hpp"

#include <utility>
#include <variant>

namespace slipwise {

Rows alike_of_positions(const std::vector<Measured>& measured, Rows squared, const Rows& expected) {
  Eigen::Index row = 0;
  for (const auto& [sensor, z] : measured) {
    if (std::holds_alternative<PositionSensor>(sensor.kind)) {
      const auto own = Eigen::seqN(row, z.size());
      const double ratio = squared(own).cwiseQuotient(expected(own)).mean();
      squared(own) = ratio * expected(own);
    }
    row += z.size();
  }
  return squared;
}

RowErrors alike_of_positions(const std::vector<Measured>& measured, const RowErrors& errors) {
  return {alike_of_positions(measured, errors.squared, errors.expected),
          alike_of_positions(measured, errors.open, errors.expected), errors.expected};
}

}  // namespace slipwise
