// SPDX-License-Identifier: Apache-2.0
// Slip that may jump at any time: a filter for each way in which it may have, weighted by how well they predict
// (Adams and MacKay 2007; Fearnhead and Liu 2007).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "slipwise/filter/causal_filter_settings.hpp"
#include "slipwise/filter/filter_state.hpp"
#include "slipwise/filter/hypothesis_bank.hpp"

namespace slipwise {

/// All parameters, had slip jumped when it was born and not since.
struct Branch {
  Estimate estimate;
  std::size_t number;  ///< in the order of births
  std::size_t born;    ///< segments that were learned until then
};

/// Whether slip jumped since the terrain counted as changed last, or the start.
struct SlipChange {
  double log_odds = 0.0;  ///< that it did; 0 where branches speak against it
  int segments = 0;       ///< since the likeliest jump, where they speak for one
  bool alarm = false;     ///< from this segment on, the terrain counts as changed
};

/// Slip of one direction: its terms, and how far each jumps where the main one jumps by 1.
struct JumpingChannel {
  std::vector<Eigen::Index> terms;
  std::vector<double> sizes;
  bool has_main = false;
};

/// What jumps together.
using JumpKind = std::vector<JumpingChannel>;

/// A segment as a bank takes it in.
struct BranchSegment {
  const InputHistory& inputs;
  const Segment& segment;
  Estimate prior;          ///< of the model, at the speeds so far
  Eigen::VectorXd unit;    ///< [slip] that each slip parameter has where it explains all motion
  ReferenceSpeeds speeds;  ///< driven so far
  double alike = 1.0;      ///< segments that count as one, since neighbours err alike
};

/// The branches of one model. Their mixture is the estimate of a filter; they share its noise, and one linearisation of
/// each segment at its mean.
class BranchBank {
 public:
  BranchBank() = default;  ///< of slip that never jumps
  BranchBank(const MotionModel& model, const BranchSettings& settings);

  /// Whether slip may jump.
  bool follow() const { return !kinds_.empty(); }
  std::size_t size() const { return branches_.size(); }
  const HypothesisBank<Branch>& branches() const { return branches_; }
  /// The mean and covariance over all branches.
  Estimate mixture() const;
  /// The same over those alone that weigh at least so much.
  Estimate mixture_above(double weight) const;
  const Estimate& leader() const { return branches_[branches_.heaviest()].estimate; }
  /// Whether with the last segment another branch came to lead: those born since the one that led hold more than half
  /// of the weight, or it alone does.
  bool leader_changed() const { return leader_changed_; }
  /// The terrain counts as changed where the odds of a jump are large, or have been even for long.
  const SlipChange& change() const { return change_; }

  /// Nothing but this is known.
  void restart(const Estimate& known);
  /// Slip jumped just now, with this probability.
  void expect_jump(const Estimate& prior, const Eigen::VectorXd& unit, double probability);
  /// What is known where slip jumped just now, of each kind and size, as likely as each other.
  std::vector<Estimate> jumps(const Estimate& known, const Eigen::VectorXd& unit) const;
  /// Slip may have become each of these just now, with these probabilities, which replace those of a recall since which
  /// nothing was learned. It is no change of terrain that was found.
  void recall(std::vector<Estimate> known, const Eigen::VectorXd& probabilities);
  /// What the branch knows that led last is known better, if it is still there.
  void correct_leader(const Estimate& better);
  /// The same data under another prior of slip; false if that of the heaviest branch cannot be changed. Others stay
  /// where theirs cannot.
  bool change_prior(const Eigen::VectorXd& old_std, const Eigen::VectorXd& new_std);

  /// Learns one segment: `state` has the mixture as its estimate.
  IekfUpdate learn(const MotionModel& model, const BranchSegment& driven, const CausalFilterSettings& settings,
                   FilterState& state);

  /// \throws std::invalid_argument where a loaded one is none that `made` could have become.
  void check_loaded(const BranchBank& made, Eigen::Index parameters) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.kinds_, self.settings_, self.branches_, self.births_, self.segments_, self.led_by_, self.known_);
    a(self.recalled_, self.held_, self.alike_, self.change_, self.leader_changed_);
  }

 private:
  static constexpr std::size_t kHeld = 10;  // segments until branches count as another terrain

  void bear(const Estimate& prior, const Eigen::VectorXd& unit, double hazard);
  void weigh(const SegmentLinearization& at, const Eigen::VectorXd& mean, const Rows& innovation,
             const RowsCovariance& noise, double alike);
  void prune();
  IekfUpdate update_all(const MotionModel& model, const BranchSegment& driven, SegmentLinearization at,
                        const RowsCovariance& noise, const IekfSettings& settings);
  double alike_of_late(double alike);
  double weight_after(std::size_t births) const;
  void follow_leader();
  SlipChange look_for_change();

  std::vector<JumpKind> kinds_;
  BranchSettings settings_;
  HypothesisBank<Branch> branches_;
  std::size_t births_ = 0;
  std::size_t segments_ = 0;   ///< learned since the start
  std::size_t led_by_ = 0;     ///< number of the branch that leads
  std::size_t known_ = 0;      ///< births until the terrain counted as changed
  std::size_t recalled_ = 0;   ///< births until the last recall
  std::size_t held_ = 0;       ///< segments for which branches that were born since have more than half of the weight
  std::vector<double> alike_;  ///< how many segments counted as one, with each of late
  SlipChange change_;
  bool leader_changed_ = false;
};

}  // namespace slipwise
