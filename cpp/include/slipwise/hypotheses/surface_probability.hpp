// SPDX-License-Identifier: Apache-2.0
// How probable each surface is to be the one under the robot.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slipwise/hypotheses/surface_list.hpp"
#include "slipwise/hypotheses/surface_trial.hpp"

namespace slipwise {

struct SurfaceProbability {
  std::string name;  ///< empty: one that has no name yet, for it was not left so far
  double probability;
};

/// Of the candidates of a trial, those without a name together; of the present surface, where there is no trial.
std::vector<SurfaceProbability> surface_probabilities(const SurfaceList& surfaces,
                                                      const std::optional<SurfaceTrial>& trial);

}  // namespace slipwise
