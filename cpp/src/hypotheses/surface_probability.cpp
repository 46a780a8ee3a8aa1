// SPDX-License-Identifier: Apache-2.0
// The candidates of a trial by their names.
#include "slipwise/hypotheses/surface_probability.hpp"

#include <algorithm>

namespace slipwise {

std::vector<SurfaceProbability> surface_probabilities(const SurfaceList& surfaces,
                                                      const std::optional<SurfaceTrial>& trial) {
  if (!trial) {
    return {{.name = surfaces.present_name(), .probability = 1.0}};
  }
  std::vector<SurfaceProbability> found;
  const Eigen::VectorXd probabilities = trial->probabilities();
  for (std::size_t i = 0; i < trial->candidates().size(); ++i) {
    const std::string name = surfaces.name_of(trial->candidates()[i]);
    auto place = std::ranges::find(found, name, &SurfaceProbability::name);
    if (place == found.end()) {
      place = found.insert(place, {.name = name, .probability = 0.0});
    }
    place->probability += probabilities[static_cast<Eigen::Index>(i)];
  }
  return found;
}

}  // namespace slipwise
