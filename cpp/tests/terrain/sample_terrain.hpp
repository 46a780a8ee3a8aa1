// SPDX-License-Identifier: Apache-2.0
// A classifier of two surfaces, ice and sand, that looks at the first current and at the first axis of vibration.
#pragma once

#include "slipwise/terrain/current_features.hpp"
#include "slipwise/terrain/terrain_classifier.hpp"

namespace slipwise::tests {

/// Ice where the first feature is at most 1.
inline TerrainTree stump() {
  return {.feature = {0, -1, -1},
          .threshold = {1.0, 0.0, 0.0},
          .left = {1, 0, 1},
          .right = {2, 0, 0},
          .leaves = (Eigen::Matrix2d() << 0.9, 0.1, 0.2, 0.8).finished()};
}

/// Five centres at -1 are ice, five at 1 sand.
inline KernelExpert kernel(Eigen::Index features) {
  Eigen::MatrixXd centres = Eigen::MatrixXd::Zero(10, features);
  Eigen::MatrixXd weights(10, 2);
  for (Eigen::Index i = 0; i < 10; ++i) {
    centres(i, 0) = i < 5 ? -1.0 : 1.0;
    weights.row(i) = i < 5 ? Eigen::RowVector2d(0.1, -0.1) : Eigen::RowVector2d(-0.1, 0.1);
  }
  return {Eigen::VectorXd::Zero(features), Eigen::VectorXd::Ones(features), 0.5, centres, weights};
}

inline TerrainClassifier classifier(Eigen::Index vibration_features) {
  TerrainExperts experts{.surfaces = {"ice", "sand"},
                         .vibration = kernel(vibration_features),
                         .current = TreeExpert({stump()}, kCurrentFeatures)};
  experts.pools[1] = ExpertPool{.current = 1.0, .doubt = 1.0};
  experts.pools[2] = ExpertPool{.vibration = 1.0, .doubt = 1.0, .newness = 0.5};
  experts.pools[3] = ExpertPool{.vibration = 1.0, .current = 1.0, .doubt = 1.0};
  return TerrainClassifier(experts);
}

}  // namespace slipwise::tests
