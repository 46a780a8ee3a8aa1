// SPDX-License-Identifier: Apache-2.0
// Finding a change of terrain: whether the last segments prefer other slip parameters than those learned before.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <vector>

namespace slipwise {

struct ChangeSettings {
  bool detect = true;
  double threshold = 3.0;  ///< log odds of a change against none beyond which there is an alarm [-]
  double suspicion = 0.5;  ///< log odds beyond which models that forgot are tried, without an alarm [-]
  int shortest = 1;        ///< segments since a change, at least
  int longest = 32;        ///< segments since a change, at most
  double fraction = 0.15;  ///< nominal size of a change of a term's slip, as a fraction of the driven twist [-]
  double forget = 0.1;     ///< on a suspicion, part of the prior variance that the slip parameters get back [-]
  int trial = 20;    ///< segments after a suspicion in which the models as they were compete with those that forgot
  int warm_up = 20;  ///< segments before the first test, in which the size of the noise is learned
  double forgetting_time = 100.0;  ///< segments over which the size and likeness of residuals are averaged [-]
};

/// The test of one segment together with those just before it.
struct ChangeTest {
  double log_odds = 0.0;   ///< of a change within the last segments; below 0 where little speaks for one
  int segments = 0;        ///< since the likeliest change
  bool suspicion = false;  ///< enough to try models that forgot
  bool alarm = false;      ///< a change was found: by the test, or since models that forgot predicted better
};

/// The ways in which a terrain may come to differ: each a list of changes that come together.
using ChangeKinds = std::vector<std::vector<Eigen::Index>>;

/// The odds of Shiryaev and Roberts that slip changed at any of the last segments, by a step from its nominal spread,
/// averaged over the kinds of change. Residuals have heavy tails; how large they are and how much those of neighbours
/// are alike is learned (derivations/change-of-ground.md).
class ChangeDetector {
 public:
  /// `kinds` are lists of columns of the `by_change` that `see` is given. Without any, nothing is ever found.
  /// \throws std::invalid_argument when the settings test no segment, or a kind is empty.
  ChangeDetector(const ChangeSettings& settings, ChangeKinds kinds);

  /// Tests whether the terrain changed before this segment or one of the last. `innovation` had covariance `covariance`
  /// under what was learned before; `by_change` is its derivative by changes in units of their nominal size. After an
  /// alarm the test starts again.
  ChangeTest see(const Eigen::Vector3d& innovation, const Eigen::Matrix3d& covariance,
                 const Eigen::Matrix<double, 3, Eigen::Dynamic>& by_change);

  /// Leaves out of the next tests what was measured before.
  void restart() { recent_.clear(); }
  /// The next segment does not follow the last one.
  void start_run() { last_.reset(); }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.settings_, self.kinds_, self.recent_, self.last_, self.known_, self.sized_, self.observed_);
  }

 private:
  struct Whitened {
    Eigen::Vector3d residual;
    Eigen::Matrix<double, 3, Eigen::Dynamic> by_change;
    double telling;  ///< 0..1, how much it could tell of a change: nothing, where the robot is parked
  };
  /// What one segment says of the changes: its part of the normal equations.
  struct Evidence {
    Eigen::MatrixXd information;
    Eigen::VectorXd score;
  };
  /// What is known of whitened residuals.
  struct Likeness {
    Eigen::Vector3d size = Eigen::Vector3d::Ones();  ///< mean squares
    Eigen::Vector3d products = Eigen::Vector3d::Zero();
    Eigen::Vector3d squares = Eigen::Vector3d::Zero();
    Eigen::Vector3d correlation() const;  ///< of neighbours
  };
  Whitened whitened(const Eigen::Vector3d& innovation, const Eigen::Matrix3d& covariance,
                    const Eigen::Matrix<double, 3, Eigen::Dynamic>& by_change) const;
  Whitened apart_from_last(const Whitened& segment) const;
  void learn_likeness(const Whitened& segment);
  ChangeTest test() const;
  double log_odds(const Evidence& sum) const;

  ChangeSettings settings_;
  ChangeKinds kinds_;
  std::deque<Evidence> recent_;
  std::optional<Whitened> last_;  ///< in units of its covariance alone
  std::deque<Likeness> known_;    ///< before each of the last segments
  double sized_ = 0.0;            ///< segments that the sizes were learned from
  double observed_ = 0.0;
};

}  // namespace slipwise
