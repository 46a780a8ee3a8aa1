// SPDX-License-Identifier: Apache-2.0
// What some sensor says of the surface: probabilities of classes that it was trained with, and of none of them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace slipwise {

/// The probabilities add up to 1: they hold if the surface is one of those that were trained.
struct TerrainAnswer {
  std::vector<std::string> classes;
  Eigen::VectorXd probability;  ///< [classes]
  double unknown = 0.0;         ///< that it is none of them, with even prior odds
};

/// \throws std::invalid_argument when there is no class, one is named twice, or a number is no probability; the
/// probabilities may add up to less or more by rounding.
void check_answer(const TerrainAnswer& answer);

}  // namespace slipwise
