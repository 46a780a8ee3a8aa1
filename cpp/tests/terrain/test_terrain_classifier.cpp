// SPDX-License-Identifier: Apache-2.0
// A classifier answers with the sensors that a window has.
#include "slipwise/terrain/terrain_classifier.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "terrain/sample_terrain.hpp"

namespace slipwise {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

TEST_CASE("a window is answered by the pool of what it has") {
  const TerrainClassifier classifier = tests::classifier(2);
  Eigen::MatrixXd vibration = Eigen::MatrixXd::Constant(4, 2, kNothing);
  Eigen::MatrixXd current = Eigen::MatrixXd::Constant(4, kCurrentFeatures, kNothing);
  vibration.row(1).setZero();
  vibration.row(3) = Eigen::RowVector2d(1.0, 0.0);
  current.row(2).setZero();
  current.row(3).setConstant(2.0);
  const TerrainAnswers found = classifier.answers(vibration, current);
  CHECK(found.kind[0] == WindowKind::Nothing);
  CHECK(found.kind[1] == WindowKind::Vibration);
  CHECK(found.kind[2] == WindowKind::Current);
  CHECK(found.kind[3] == WindowKind::Both);
  CHECK_FALSE(found.probability.row(0).allFinite());
  CHECK(found.probability(1, 0) == doctest::Approx(0.5));
  CHECK(found.probability(2, 0) == doctest::Approx(0.91 / 1.02));
  CHECK(found.probability(3, 1) > 0.95);
  CHECK(found.unknown[1] > found.unknown[3]);
}

TEST_CASE("one window has one answer, or none") {
  const TerrainClassifier classifier = tests::classifier(2);
  const Eigen::VectorXd nothing = Eigen::VectorXd::Constant(2, kNothing);
  const auto answer = classifier.answer(nothing, Eigen::VectorXd::Zero(kCurrentFeatures));
  REQUIRE(answer);
  CHECK(answer->classes.front() == "ice");
  CHECK(answer->probability.sum() == doctest::Approx(1.0));
  CHECK_FALSE(classifier.answer(nothing, Eigen::VectorXd::Constant(kCurrentFeatures, kNothing)));
}

TEST_CASE("an expert without a pool, or of other surfaces, is refused") {
  TerrainExperts experts{.surfaces = {"ice", "sand"}, .current = TreeExpert({tests::stump()}, kCurrentFeatures)};
  CHECK_THROWS_AS(TerrainClassifier{experts}, std::invalid_argument);
  experts.pools[1] = ExpertPool{.current = 1.0};
  CHECK_NOTHROW(TerrainClassifier{experts});
  experts.surfaces.emplace_back("snow");
  CHECK_THROWS_AS(TerrainClassifier{experts}, std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
