// SPDX-License-Identifier: Apache-2.0
// Asks the experts that a window has measurements for, and pools what they say.
#include "slipwise/terrain/terrain_classifier.hpp"

#include <limits>
#include <stdexcept>
#include <utility>

namespace slipwise {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// The rows that are whole.
std::vector<Eigen::Index> whole_rows(const Eigen::Ref<const Eigen::MatrixXd>& rows) {
  std::vector<Eigen::Index> whole;
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    if (rows.row(i).allFinite()) {
      whole.push_back(i);
    }
  }
  return whole;
}

void check_expert(const TerrainExperts& experts, Eigen::Index surfaces, WindowKind kind) {
  if (surfaces != std::ssize(experts.surfaces) || !experts.pools[static_cast<std::size_t>(kind)]) {
    throw std::invalid_argument("an expert of terrain knows another number of surfaces, or has no pool");
  }
}

}  // namespace

TerrainClassifier::TerrainClassifier(TerrainExperts experts) : experts_(std::move(experts)) {
  if (experts_.surfaces.empty() || (!experts_.vibration && !experts_.current)) {
    throw std::invalid_argument("a classifier of terrain needs surfaces and an expert");
  }
  if (experts_.vibration) {
    check_expert(experts_, experts_.vibration->surfaces(), WindowKind::Vibration);
  }
  if (experts_.current) {
    check_expert(experts_, experts_.current->surfaces(), WindowKind::Current);
  }
  if (experts_.vibration && experts_.current) {
    check_expert(experts_, experts_.current->surfaces(), WindowKind::Both);
  }
}

TerrainAnswers TerrainClassifier::answers(const Eigen::Ref<const Eigen::MatrixXd>& vibration,
                                          const Eigen::Ref<const Eigen::MatrixXd>& current) const {
  const Eigen::Index windows = vibration.rows();
  if (current.rows() != windows) {
    throw std::invalid_argument("windows need one row of each sensor");
  }
  const auto surfaces = std::ssize(experts_.surfaces);
  Eigen::MatrixXd by_vibration = Eigen::MatrixXd::Constant(windows, surfaces, kNothing);
  Eigen::MatrixXd by_current = by_vibration;
  Eigen::VectorXd newness = Eigen::VectorXd::Zero(windows);
  std::vector<int> kinds(static_cast<std::size_t>(windows), 0);
  const auto mark = [&](const std::vector<Eigen::Index>& rows, WindowKind kind) {
    for (const Eigen::Index i : rows) {
      kinds[static_cast<std::size_t>(i)] += static_cast<int>(kind);
    }
  };
  if (experts_.vibration) {
    const auto rows = whole_rows(vibration);
    const Eigen::MatrixXd features = vibration(rows, Eigen::all);
    by_vibration(rows, Eigen::all) = experts_.vibration->probabilities(features);
    const Eigen::VectorXd of_rows = experts_.vibration->newness(features);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      newness[rows[i]] = of_rows[static_cast<Eigen::Index>(i)];
    }
    mark(rows, WindowKind::Vibration);
  }
  if (experts_.current) {
    const auto rows = whole_rows(current);
    by_current(rows, Eigen::all) = experts_.current->probabilities(current(rows, Eigen::all));
    mark(rows, WindowKind::Current);
  }
  TerrainAnswers found{.kind = {},
                       .probability = Eigen::MatrixXd::Constant(windows, surfaces, kNothing),
                       .unknown = Eigen::VectorXd::Constant(windows, kNothing)};
  for (Eigen::Index i = 0; i < windows; ++i) {
    found.kind.push_back(static_cast<WindowKind>(kinds[static_cast<std::size_t>(i)]));
    if (const auto& pool = experts_.pools[static_cast<std::size_t>(found.kind.back())]) {
      found.probability.row(i) = pool->pooled(by_vibration.row(i), by_current.row(i));
      found.unknown.segment<1>(i) = pool->unknown(found.probability.row(i), newness.segment<1>(i));
    }
  }
  return found;
}

std::optional<TerrainAnswer> TerrainClassifier::answer(const Eigen::Ref<const Eigen::VectorXd>& vibration,
                                                       const Eigen::Ref<const Eigen::VectorXd>& current) const {
  const TerrainAnswers found = answers(vibration.transpose(), current.transpose());
  if (found.kind.front() == WindowKind::Nothing) {
    return std::nullopt;
  }
  return TerrainAnswer{
      .classes = experts_.surfaces, .probability = found.probability.row(0), .unknown = found.unknown[0]};
}

}  // namespace slipwise
