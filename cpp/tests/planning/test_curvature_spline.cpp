// SPDX-License-Identifier: Apache-2.0
// The weights of the curvature's control points.
#include <doctest/doctest.h>

#include "slipwise/planning/curvature_spline.hpp"

namespace slipwise {
namespace {

TEST_CASE("curvature stays between its control points because weights are positive and sum to one") {
  for (int i = 0; i <= 1000; ++i) {
    const CurvatureWeights weights = curvature_weights(i / 1000.0);
    CHECK(weights.minCoeff() >= 0.0);
    CHECK(weights.sum() == doctest::Approx(1.0));
  }
}

TEST_CASE("curvature begins at the first control point and ends at the last, without jumps") {
  CHECK(curvature_weights(0.0)[0] == doctest::Approx(1.0));
  CHECK(curvature_weights(1.0)[kCurvaturePoints - 1] == doctest::Approx(1.0));
  for (int i = 0; i < 10000; ++i) {
    const CurvatureWeights step = curvature_weights((i + 1) / 10000.0) - curvature_weights(i / 10000.0);
    CHECK(step.cwiseAbs().maxCoeff() < 2e-3);
  }
}

}  // namespace
}  // namespace slipwise
