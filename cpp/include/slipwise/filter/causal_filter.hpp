// SPDX-License-Identifier: Apache-2.0
// Learning one model segment by segment: prior that follows the speeds, IEKF update, noise that follows the residuals,
// and refits of the first segments, where noise and linearisation were guesses.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "slipwise/filter/body_force.hpp"
#include "slipwise/filter/branch_bank.hpp"
#include "slipwise/filter/causal_filter_settings.hpp"
#include "slipwise/filter/filter_refit.hpp"
#include "slipwise/filter/filter_state.hpp"
#include "slipwise/filter/iekf.hpp"
#include "slipwise/filter/noise_scale.hpp"
#include "slipwise/filter/prior.hpp"
#include "slipwise/filter/score_covariance.hpp"
#include "slipwise/filter/slip_cue.hpp"
#include "slipwise/filter/speed_range.hpp"
#include "slipwise/filter/surface_slip.hpp"

namespace slipwise {

class CausalFilter {
 public:
  CausalFilter();  ///< of a model without parameters
  CausalFilter(MotionModel model, const CausalFilterSettings& settings);
  CausalFilter(const CausalFilter&);
  CausalFilter(CausalFilter&&) noexcept;
  CausalFilter& operator=(const CausalFilter&);
  CausalFilter& operator=(CausalFilter&&) noexcept;
  ~CausalFilter();

  /// Learns one segment. `speeds` are those driven up to the segment's end. After 8, 11, 16, ... 256 segments a refit
  /// of all of them begins; it takes effect a sixteenth as many segments later, or as many as its work takes by a
  /// bounded share of it each, whether `refit_slice` was called meanwhile or not. The update returned is that of the
  /// segment alone.
  IekfUpdate learn(const InputHistory& inputs, const Segment& segment, const ReferenceSpeeds& speeds);
  /// Does a bounded slice of the refit's work; false where there is none to do now. Results do not depend on it.
  bool refit_slice();
  /// Whether a refit took effect with the last segment.
  bool refitted() const { return refitted_; }
  /// The ways in which slip may have jumped, where it may.
  const BranchBank& branches() const { return branches_; }

  /// Something says how slip is, or may be, now.
  void take(const SlipCue& cue);

  /// The estimate of the surface that is driven on, apart from the robot.
  SurfaceSlip surface() const;
  /// Goes on with the slip of a surface; what is the robot's stays as learned. `drift` of its prior variance is added:
  /// no surface is quite as it was.
  void go_on_with(const SurfaceSlip& surface, double drift);
  /// Slip may have become that of a surface just now; `drift` as above. Where slip never jumps, it stays as it is.
  void recall(std::span<const RecalledSlip> known, double drift);
  /// The robot is as it was learned before: `robot` are the parameters after those of slip.
  void know_robot(const Estimate& robot);
  /// The prior of a surface that was never driven, from those that were (derivations/surfaces.md).
  SurfaceSlip new_surface(std::span<const SurfaceSlip> known) const;
  const ReferenceSpeeds& speeds() const { return speeds_; }

  const MotionModel& model() const { return model_; }
  /// What learning goes on from: the noise is taken to be of the shape given.
  const Estimate& estimate() const { return state_.estimate; }
  /// The same with a covariance that also holds where it is not, or where slip is correlated in time.
  Estimate reported() const;
  /// Standard deviations of the prior now in force, [parameters].
  Eigen::VectorXd prior_std() const;
  /// Of slip, [slip], at other speeds.
  Eigen::VectorXd slip_std_at(const ReferenceSpeeds& speeds) const;
  /// Learned factor of the noise variances of (x, y, theta).
  Eigen::Vector3d noise_scale() const { return state_.noise_scale.value(); }
  const NoiseSettings& noise() const { return settings_.noise; }

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const CausalFilter& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.model_, self.settings_, self.speeds_, self.started_, self.state_, self.before_, self.noise_before_,
      self.kept_, self.next_refit_, self.full_);
    a(self.slip_std_, self.stated_, self.refit_, self.refitted_, self.force_, self.force_at_, self.branches_,
      self.lasting_);
  }

 private:
  void forget(double fraction);
  void expect_change();
  Estimate on_surface(const SurfaceSlip& surface, double drift) const;
  void follow(const ReferenceSpeeds& speeds);
  Estimate prior(const ReferenceSpeeds& speeds) const;
  Eigen::VectorXd unit() const;
  void pass(const Segment& segment);
  void keep(const InputHistory& inputs, const Segment& segment);
  void end_refit();
  void start_from_here();
  void start_refits(const Estimate& before);
  IekfUpdate follow_branches(const InputHistory& inputs, const Segment& segment);

  /// A refit that is under way.
  struct Refit {
    FilterRefit work;
    Eigen::VectorXd slip_std;  ///< of the prior under which it began
    std::size_t begun;         ///< segments after which it began

    std::size_t due(std::size_t segments) const;  ///< slices, after so many segments
  };

  MotionModel model_;
  CausalFilterSettings settings_;
  ReferenceSpeeds speeds_{};
  bool started_ = false;
  FilterState state_;
  Estimate before_;                  ///< what was known before the segments that are kept,
  NoiseScale noise_before_;          ///< and of the noise
  std::vector<DrivenSegment> kept_;  ///< the first since the start, or since the terrain changed
  double next_refit_;                ///< segments after which a refit begins, rounded
  bool full_ = false;                ///< no more are kept
  Eigen::VectorXd slip_std_;
  Eigen::VectorXd stated_;  ///< factors of the standard deviations, as the scores show them
  std::optional<Refit> refit_;
  bool refitted_ = false;
  BodyForce force_;
  double force_at_;  ///< [s] middle of the segment that spoke of it last
  BranchBank branches_;
  double lasting_ = kUsualCorrelationTime;  ///< [s]
};

/// Covariance of what is predicted: parameters, slip noise and, where `with_pose_noise`, the two measured poses.
RowsCovariance prediction_covariance(const SegmentLinearization& at,
                                     const Eigen::Ref<const Eigen::MatrixXd>& parameters, const MotionNoise& shape,
                                     const Eigen::Vector3d& scale);

}  // namespace slipwise
