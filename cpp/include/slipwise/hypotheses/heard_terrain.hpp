// SPDX-License-Identifier: Apache-2.0
// What sensors say of the terrain, on the present surface and in a trial.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "slipwise/hypotheses/surface_list.hpp"

namespace slipwise {

/// `here` is the name of the surface that is driven on. In a trial all that was said counts as one cue, since answers
/// miss alike.
class HeardTerrain {
 public:
  /// Takes in what is `said` while nothing competes but these. Whether another surface explains it far better than the
  /// present one, which counts once for each class: then a trial is to begin, in which it is said.
  bool hear(const ClassCounts& said, const std::vector<SurfaceCandidate>& candidates, const SurfaceList& surfaces,
            const std::string& here);
  /// Takes it in during a trial; returns the log factors of the candidates' odds that it changes them by.
  Eigen::VectorXd hear_in_trial(const ClassCounts& said, const std::vector<SurfaceCandidate>& candidates,
                                const SurfaceList& surfaces, const std::string& here);

  /// Nothing was said yet on the surface that is driven on.
  void begin();
  void begin_trial(std::size_t candidates);
  /// What was said in the trial was said of the surface that it took, the present one or another.
  void end_trial(bool another);
  /// Any class may begin a trial again.
  void forget_doubt() { doubted_for_.clear(); }
  /// Counts with the surface what was said on it.
  void leave(Surface& surface);
  /// Whether there is a factor for each of so many candidates.
  bool fits(std::size_t candidates) const { return factors_.size() == candidates; }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.heard_, self.in_trial_, self.factors_, self.doubted_for_);
  }

 private:
  Eigen::ArrayXd likelihoods(const ClassCounts& said, const std::vector<SurfaceCandidate>& candidates,
                             const SurfaceList& surfaces, const std::string& here) const;

  ClassCounts heard_;            ///< on the present surface since it was taken
  ClassCounts in_trial_;         ///< since the trial began
  std::vector<double> factors_;  ///< log factors of the candidates that this has been worth so far
  std::string doubted_for_;      ///< class that began the last trial on the present surface
};

}  // namespace slipwise
