// SPDX-License-Identifier: Apache-2.0
// Labels of surfaces: names, and odds of the surfaces that bore them before.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "slipwise/hypotheses/surface_list.hpp"

namespace slipwise {

/// How often labels named the surface that was then taken.
struct LabelCounts {
  double all = 0.0;
  double right = 0.0;

  /// How often labels are right: the mean of a Beta distribution that began with 9 of 10.
  double reliability() const { return (right + 9.0) / (all + 10.0); }
};

/// The label that speaks, how reliable labels are, and the name that a new surface will get.
class SurfaceLabels {
 public:
  const LabelCounts& counts() const { return counts_; }
  void know(const LabelCounts& counts) { counts_ = counts; }

  /// The one that speaks in the trial; empty where none does.
  const std::string& label() const { return label_; }
  void say(const std::string& label) { label_ = label; }
  /// The same at the start of a drive, or where the surface changes: if no surface is known, the new one is called so.
  void start_drive(const std::string& label, const SurfaceList& surfaces);
  void change(const std::string& label, const SurfaceList& surfaces);

  /// The name of the surface that has no entry yet; empty where no label gives it one.
  const std::string& wanted() const { return wanted_; }
  std::string take_wanted() { return std::exchange(wanted_, {}); }
  /// A new surface is called as the label says, unless another one is.
  void name_new(const SurfaceList& surfaces) { wanted_ = surfaces.taken(label_) ? "" : label_; }
  /// The name of the surface that is driven on, whether it has an entry or not.
  std::string name_here(const SurfaceList& surfaces) const;

  /// How likely the label is on each candidate, by what labels have been worth: it names the surface, or another one. A
  /// label that names no surface speaks for those without a name of their own.
  Eigen::ArrayXd factors(const std::vector<SurfaceCandidate>& candidates, const SurfaceList& surfaces) const;
  /// Multiplies the prior of each candidate by them.
  void weigh(std::vector<SurfaceCandidate>& candidates, const SurfaceList& surfaces) const;
  /// Counts whether the label was right, as far as the surface that was taken tells; returns the name of the one that
  /// was recalled. One that had a number for a name gets the label for its name.
  std::string judge(const SurfaceCandidate& taken, const std::string& recalled, bool sure, SurfaceList& surfaces);

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.label_, self.wanted_, self.counts_);
  }

 private:
  std::string label_;
  std::string wanted_;
  LabelCounts counts_;
};

}  // namespace slipwise
