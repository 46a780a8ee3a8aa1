// SPDX-License-Identifier: Apache-2.0
// Uses the installed library: drives a quarter circle.
#include <cmath>
#include <numbers>
#include <slipwise/lie/se2.hpp>
#include <slipwise/slip/basis.hpp>

int main() {
  const double quarter = std::numbers::pi / 2.0;
  const auto pose = slipwise::exp({quarter, 0.0, quarter});
  const bool arrived = std::abs(pose.x - 1.0) < 1e-12 && std::abs(pose.y - 1.0) < 1e-12;
  return arrived && !slipwise::basis_names().empty() ? 0 : 1;
}
