// SPDX-License-Identifier: Apache-2.0
// Finding a change of terrain: whether the last segments prefer other slip parameters than those learned before.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "slipwise/sensor/seen.hpp"

namespace slipwise {

struct ChangeSettings {
  bool detect = true;
  double threshold = 9.5;  ///< log odds of a change against none beyond which there is an alarm [-]
  double suspicion = 3.0;  ///< log odds beyond which models that forgot are tried, without an alarm [-]
  int shortest = 2;        ///< segments that must agree: one alone is an outlier, not a terrain
  int longest = 8;         ///< segments that are tested together, at most
  double fraction = 0.1;   ///< nominal size of a change of a term's slip, as a fraction of the driven twist [-]
  double forget = 0.1;     ///< on a suspicion, part of the prior variance that the slip parameters get back [-]
  int trial = 20;    ///< segments after a suspicion in which the models as they were compete with those that forgot
  int warm_up = 20;  ///< segments before the first test, in which the size of the noise is learned
  double forgetting_time = 100.0;  ///< segments over which the nominal size and likeness of residuals are averaged [-]
};

/// The test of one segment together with those just before it.
struct ChangeTest {
  double log_odds = 0.0;   ///< of the likeliest change; 0 where nothing speaks for one
  int segments = 0;        ///< since that change
  bool suspicion = false;  ///< enough to try models that forgot
  bool alarm = false;      ///< a change was found: by the test, or since models that forgot predicted better
};

/// Log odds that a change explains residuals, and what the fit of the change expects of unchanged terrain.
struct ChangeFit {
  double log_odds;
  double gain;           ///< of the log likelihood, less what the change costs
  double expected_gain;  ///< of white residuals on unchanged terrain
};

/// `residuals` are whitened, [rows n], of as many `rows` a segment; the columns of `by_change` are their derivatives by
/// independent changes in units of their nominal size, [rows n, changes]. Residuals and changes have heavy tails
/// (derivations/surfaces.md).
ChangeFit fit_change(const Eigen::VectorXd& residuals, const Eigen::MatrixXd& by_change, Eigen::Index rows = 3);

/// The ways in which a terrain may come to differ: each a list of changes that come together.
using ChangeKinds = std::vector<std::vector<Eigen::Index>>;

/// A Bayesian likelihood ratio over the last segments, averaged over the kinds of change and weighted against what is
/// nominal on this terrain: residuals that are always small tell of a change sooner, and neighbouring residuals that
/// are always alike (a slip disturbance) are no change.
class ChangeDetector {
 public:
  /// `kinds` are lists of columns of the `by_change` that `see` is given. Without any, nothing is ever found.
  /// \throws std::invalid_argument when the settings test no segment, or a kind is empty.
  ChangeDetector(const ChangeSettings& settings, ChangeKinds kinds);

  /// Tests whether the terrain changed before this segment or one of the last. `innovation`, of rows of these
  /// directions, had covariance `covariance` under what was learned before; `by_change` is its derivative by changes in
  /// units of their nominal size. After an alarm the test starts again.
  ChangeTest see(const Directions& directions, const Rows& innovation, const RowsCovariance& covariance,
                 const RowsJacobian& by_change);

  /// Leaves out of the next tests what was measured before.
  void restart() { recent_.clear(); }

  /// \throws std::invalid_argument where a loaded one is none that `made`, which is given so many `changes`, could
  /// have become.
  void check_loaded(const ChangeDetector& made, Eigen::Index changes) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.settings_, self.kinds_, self.recent_, self.sizes_, self.sized_, self.nominal_, self.observed_);
  }

 private:
  struct Whitened {
    Rows residual;
    RowsJacobian by_change;
  };
  Whitened whitened(const Directions& directions, const Rows& innovation, const RowsCovariance& covariance,
                    const RowsJacobian& by_change);
  double test_last(int segments);
  ChangeFit fit_last(int segments, const std::vector<Eigen::Index>& kind, double nominal) const;
  void learn_nominal(double& nominal, const ChangeFit& fit) const;

  ChangeSettings settings_;
  ChangeKinds kinds_;
  std::deque<Whitened> recent_;
  std::deque<Eigen::Vector3d>
      sizes_;                ///< mean squares of whitened residuals, as known before each of the last segments
  double sized_ = 0.0;       ///< segments that the sizes were learned from
  Eigen::MatrixXd nominal_;  ///< [segments + 1, kinds] gain over its expectation: 1 where residuals are white
  double observed_ = 0.0;
};

}  // namespace slipwise
