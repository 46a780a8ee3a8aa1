// SPDX-License-Identifier: Apache-2.0
// Which classes of terrain were said on which surface: what a sensor's class says of the surface, and the other way
// round (derivations/surfaces.md).
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "slipwise/terrain/terrain_answer.hpp"

namespace slipwise {

/// How much each class was said, each by its name: of a surface in visits, of which each counts one.
using ClassCounts = std::vector<std::pair<std::string, double>>;

/// That of one class, which is added where there is none.
double& count_in(ClassCounts& counts, const std::string& name);

inline constexpr const char* kUnknownClass = "unknown";  ///< what a sensor says of terrain that it was not trained with

/// A surface by its name and what was said on it.
struct NamedClasses {
  std::string name;
  ClassCounts classes;
};

/// Adds more of them.
void add_counts(const ClassCounts& more, ClassCounts& counts);

/// How much of all each is; there is some.
ClassCounts shares_of(ClassCounts counts);

/// The probability of each class, and of "unknown", where the prior odds are even.
ClassCounts even_odds(const TerrainAnswer& answer);

/// P(what was said | surface), but for a constant, for classes that were `said` as often: a Dirichlet posterior over
/// the classes. A class of the surface's name begins with nine visits, as a label that is right in nine of ten cases;
/// all classes together with one. A surface of no name is one that nothing is known of.
double likelihood_of(const ClassCounts& said, const NamedClasses& surface);

/// P(surface | class) of each surface, and last of a new one: of ten times that a class was said on surfaces, it stays
/// one that it was somewhere new. A class that was never said before, and that no surface is called by, is a new one's.
Eigen::VectorXd surfaces_of_class(const std::string& name, std::span<const NamedClasses> surfaces);

/// Adds what was said in one visit, which counts one.
void add_visit(const ClassCounts& said, ClassCounts& classes);

}  // namespace slipwise
