// SPDX-License-Identifier: Apache-2.0
// Surfaces that compete to be the one that is driven on. Who wins gives a name; what predicts goes on beside it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "slipwise/filter/hypothesis_bank.hpp"
#include "slipwise/hypotheses/remembering_average.hpp"
#include "slipwise/hypotheses/surface_evidence.hpp"
#include "slipwise/hypotheses/surface_memory.hpp"

namespace slipwise {

/// Candidates at the start of a drive, of so many known surfaces. Of those that were never driven, most are like one
/// that was, but for a jump.
std::vector<SurfaceCandidate> candidates_of_start(std::size_t surfaces, const SurfaceSettings& settings);
/// Candidates where something changed; the first is the `present` surface, which need not have an entry yet. Where that
/// was recalled of late, `doubted`, it is as it is remembered: what was learned since may be wrong.
std::vector<SurfaceCandidate> candidates_of_change(std::size_t surfaces, std::optional<std::size_t> present,
                                                   bool doubted, const SurfaceSettings& settings);

/// What a trial says.
struct SurfaceDecision {
  std::size_t known = 0;     ///< the likeliest candidate that was driven before
  double probability = 0.0;  ///< of it
  double another = 0.0;      ///< probability of those that were not, together
  bool sure = false;         ///< one of both is certain enough, after enough segments
};

/// Candidates by the joint density of all segments so far (derivations/surfaces.md).
class SurfaceTrial {
 public:
  SurfaceTrial() = default;
  /// `known` are the memories that `average` has of the surfaces. Its segments from `since` [s] on speak first.
  SurfaceTrial(std::vector<SurfaceCandidate> candidates, std::span<const SurfaceMemory> known,
               const RememberingAverage& average, const DisturbanceModel& law, double since);

  /// Takes in the last segment of the average, once.
  void follow(const RememberingAverage& average);
  /// Weights the candidates from outside: log factors of their odds, which count from now on.
  void weigh(const Eigen::VectorXd& log_factors) { evidence_.weigh(log_factors); }

  /// Only a known surface, which is the present one now, and one that is like it go on to compete.
  void hold(std::size_t candidate);

  /// `by_label` are the odds that a label gives the candidates: it is not overruled at once. A known surface is taken
  /// sooner than another, for what it is like is known.
  SurfaceDecision decide(const Eigen::ArrayXd& by_label, const SurfaceSettings& settings) const;

  const std::vector<SurfaceCandidate>& candidates() const { return candidates_; }
  const Eigen::VectorXd& probabilities() const { return evidence_.weights(); }
  int segments() const { return segments_; }  ///< that the evidence comes from

  /// \throws std::invalid_argument where a loaded one does not fit the model, or this number of surfaces.
  void check_loaded(const MotionModel& model, std::size_t surfaces) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.candidates_, self.evidence_, self.segments_, self.last_);
  }

 private:
  std::vector<SurfaceCandidate> candidates_;
  HypothesisBank<SurfaceEvidence> evidence_;  ///< for each
  int segments_ = 0;
  double last_ = 0.0;  ///< end of the last segment [s]
};

}  // namespace slipwise
