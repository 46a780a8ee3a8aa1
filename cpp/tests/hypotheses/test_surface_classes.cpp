// SPDX-License-Identifier: Apache-2.0
// Counts of classes per surface say what a class means.
#include "slipwise/hypotheses/surface_classes.hpp"

#include <doctest/doctest.h>

namespace slipwise {
namespace {

const std::vector<NamedClasses> kSurfaces{
    {"surface 1", {{"brown", 3.0}}}, {"surface 2", {{"white", 6.0}, {"brown", 1.0}}}, {"grass", {}}};

TEST_CASE("a class is of the surfaces that it was said on, and of a new one the less the more often") {
  const Eigen::VectorXd brown = surfaces_of_class("brown", kSurfaces);
  CHECK(brown[0] == doctest::Approx(3.0 / 5.0));
  CHECK(brown[1] == doctest::Approx(1.0 / 5.0));
  CHECK(brown[2] == 0.0);
  CHECK(brown[3] == doctest::Approx(1.0 / 5.0));
}

TEST_CASE("a class that was never said is a new surface's, unless a surface is called so") {
  CHECK(surfaces_of_class("blue", kSurfaces)[3] == 1.0);
  CHECK(surfaces_of_class("grass", kSurfaces)[2] == doctest::Approx(0.9));
}

TEST_CASE("what was said is likelier where it was said before, and even where nothing was") {
  const ClassCounts said{{"brown", 0.0}, {"white", 1.0}, {kUnknownClass, 0.0}};
  CHECK(likelihood_of(said, kSurfaces[0]) == doctest::Approx((1.0 / 3.0) / 4.0));
  CHECK(likelihood_of(said, kSurfaces[1]) == doctest::Approx((6.0 + 1.0 / 3.0) / 8.0));
  CHECK(likelihood_of(said, kSurfaces[2]) == doctest::Approx(1.0 / 3.0));
  CHECK(likelihood_of({{"grass", 1.0}, {kUnknownClass, 0.0}}, kSurfaces[2]) == doctest::Approx(9.5 / 10.0));
}

TEST_CASE("unknown is one class more, as likely as each other beforehand") {
  const ClassCounts odds = even_odds({{"a", "b", "c"}, Eigen::Vector3d(0.5, 0.3, 0.2), 0.5});
  double total = 0.0;
  for (const auto& [name, each] : odds) {
    total += each;
  }
  CHECK(total == doctest::Approx(1.0));
  CHECK(odds.back().first == kUnknownClass);
  CHECK(odds.back().second == doctest::Approx(0.25));
}

TEST_CASE("a visit counts one, however much was said in it") {
  ClassCounts classes{{"brown", 1.0}};
  add_visit({{"brown", 30.0}, {"white", 10.0}}, classes);
  CHECK(classes[0].second == doctest::Approx(1.75));
  CHECK(classes[1].second == doctest::Approx(0.25));
  add_visit({}, classes);
  CHECK(classes.size() == 2);
}

}  // namespace
}  // namespace slipwise
