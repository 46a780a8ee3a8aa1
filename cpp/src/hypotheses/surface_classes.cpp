// SPDX-License-Identifier: Apache-2.0
// Counts of classes per surface, as Dirichlet distributions.
#include "slipwise/hypotheses/surface_classes.hpp"

#include <algorithm>
#include <utility>

namespace slipwise {
namespace {

constexpr double kNamed = 9.0;  // visits that a class is worth on a surface of its name, before any
constexpr double kOpen = 1.0;   // visits that stand for all that was not seen yet

double total_of(const ClassCounts& counts) {
  double total = 0.0;
  for (const auto& [name, count] : counts) {
    total += count;
  }
  return total;
}

double count_of(const ClassCounts& counts, const std::string& name) {
  const auto found = std::ranges::find(counts, name, &ClassCounts::value_type::first);
  return found == counts.end() ? 0.0 : found->second;
}

double known_visits(const NamedClasses& surface, const std::string& name) {
  return count_of(surface.classes, name) + (surface.name == name && !name.empty() ? kNamed : 0.0);
}

}  // namespace

double& count_in(ClassCounts& counts, const std::string& name) {
  auto found = std::ranges::find(counts, name, &ClassCounts::value_type::first);
  if (found == counts.end()) {
    found = counts.insert(found, {name, 0.0});
  }
  return found->second;
}

void add_counts(const ClassCounts& more, ClassCounts& counts) {
  for (const auto& [name, each] : more) {
    count_in(counts, name) += each;
  }
}

ClassCounts shares_of(ClassCounts counts) {
  const double total = total_of(counts);
  for (auto& [name, each] : counts) {
    each /= total;
  }
  return counts;
}

ClassCounts even_odds(const TerrainAnswer& answer) {
  ClassCounts odds;
  const auto classes = static_cast<double>(answer.classes.size());
  for (std::size_t i = 0; i < answer.classes.size(); ++i) {
    count_in(odds, answer.classes[i]) +=
        classes * (1.0 - answer.unknown) * answer.probability[static_cast<Eigen::Index>(i)];
  }
  count_in(odds, kUnknownClass) += answer.unknown;
  return shares_of(std::move(odds));
}

double likelihood_of(const ClassCounts& said, const NamedClasses& surface) {
  const double open = kOpen / static_cast<double>(said.size());
  double visits = 0.0;
  double weighted = 0.0;
  for (const auto& [name, share] : said) {
    const double known = known_visits(surface, name) + open;
    visits += known;
    weighted += known * share;
  }
  return weighted / visits;
}

Eigen::VectorXd surfaces_of_class(const std::string& name, std::span<const NamedClasses> surfaces) {
  Eigen::VectorXd found(std::ssize(surfaces) + 1);
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    found[static_cast<Eigen::Index>(i)] = known_visits(surfaces[i], name);
  }
  found[std::ssize(surfaces)] = kOpen;
  return found / found.sum();
}

void add_visit(const ClassCounts& said, ClassCounts& classes) {
  const double total = total_of(said);
  for (const auto& [name, each] : said) {
    if (each > 0.0 && total > 0.0) {
      count_in(classes, name) += each / total;
    }
  }
}

}  // namespace slipwise
