// SPDX-License-Identifier: Apache-2.0
// The candidates of a trial by their names.
#include <doctest/doctest.h>

#include "slipwise/hypotheses/surface_probability.hpp"

namespace slipwise {
namespace {

using Kind = SurfaceCandidate::Kind;

TEST_CASE("where nothing competes the surface under the robot is certain") {
  const auto found = surface_probabilities(SurfaceBank(), std::nullopt);
  REQUIRE(found.size() == 1);
  CHECK(found.front().name.empty());
  CHECK(found.front().probability == 1.0);
}

TEST_CASE("candidates that have no name yet are taken together") {
  SurfaceTrial trial;
  trial.candidates = {{.kind = Kind::Present}, {.kind = Kind::Changed}, {.kind = Kind::New}};
  for (const double log_odds : {0.0, -1.0, -2.0}) {
    trial.sides.add({}, 1.0, log_odds);
  }
  trial.sides.weigh(Eigen::Vector3d::Zero());
  const auto found = surface_probabilities(SurfaceBank(), trial);
  REQUIRE(found.size() == 1);
  CHECK(found.front().probability == doctest::Approx(1.0));
}

}  // namespace
}  // namespace slipwise
