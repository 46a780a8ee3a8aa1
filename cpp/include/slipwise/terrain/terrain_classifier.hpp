// SPDX-License-Identifier: Apache-2.0
// Names the surface under a robot by what its IMU and its motor currents feel: experts, pooled and calibrated.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slipwise/terrain/expert_pool.hpp"
#include "slipwise/terrain/terrain_answer.hpp"
#include "slipwise/terrain/terrain_experts.hpp"

namespace slipwise {

/// What a window has.
enum class WindowKind : std::uint8_t { Nothing, Current, Vibration, Both };
inline constexpr std::size_t kWindowKinds = 4;

/// What was learned about surfaces.
struct TerrainExperts {
  std::vector<std::string> surfaces;
  std::optional<KernelExpert> vibration = {};
  std::optional<TreeExpert> current = {};
  std::array<std::optional<ExpertPool>, kWindowKinds> pools = {};  ///< by what a window has
};

/// Answers for windows, [N] or [N, K]; not a number where a window has no measurement that is known.
struct TerrainAnswers {
  std::vector<WindowKind> kind;
  Eigen::MatrixXd probability;  ///< of each surface, if it is one of those that were trained
  Eigen::VectorXd unknown;      ///< that it is none of them, with even prior odds
};

class TerrainClassifier {
 public:
  /// \throws std::invalid_argument when experts know other numbers of surfaces, or an expert has no pool.
  explicit TerrainClassifier(TerrainExperts experts);

  const std::vector<std::string>& surfaces() const { return experts_.surfaces; }
  /// What windows say with all the sensors that they have: features of vibration [N, V] and currents [N, C], in rows
  /// that are not numbers where a window has no such measurement.
  /// \throws std::invalid_argument when there are other features than were trained with.
  TerrainAnswers answers(const Eigen::Ref<const Eigen::MatrixXd>& vibration,
                         const Eigen::Ref<const Eigen::MatrixXd>& current) const;
  /// The same of one window; empty if it has no known measurement.
  std::optional<TerrainAnswer> answer(const Eigen::Ref<const Eigen::VectorXd>& vibration,
                                      const Eigen::Ref<const Eigen::VectorXd>& current) const;

 private:
  TerrainExperts experts_;
};

}  // namespace slipwise
