// SPDX-License-Identifier: Apache-2.0
// Which answers of a sensor make sense.
#include "slipwise/terrain/terrain_answer.hpp"

#include <cmath>
#include <set>
#include <stdexcept>

namespace slipwise {
namespace {

constexpr double kRounding = 0.02;  // of a sum of probabilities that were written with few digits

}  // namespace

void check_answer(const TerrainAnswer& answer) {
  const std::set<std::string> names(answer.classes.begin(), answer.classes.end());
  if (answer.classes.empty() || names.size() != answer.classes.size() || names.contains("")) {
    throw std::invalid_argument("classes of terrain need names, each its own");
  }
  const bool sizes = answer.probability.size() == std::ssize(answer.classes);
  if (!sizes || !answer.probability.allFinite() || (answer.probability.array() < 0.0).any() ||
      !(std::abs(answer.probability.sum() - 1.0) <= kRounding)) {
    throw std::invalid_argument("the probabilities of terrain must be one per class and add up to 1");
  }
  if (!(answer.unknown >= 0.0) || !(answer.unknown <= 1.0)) {
    throw std::invalid_argument("the probability of unknown terrain must lie between 0 and 1, got " +
                                std::to_string(answer.unknown));
  }
}

}  // namespace slipwise
