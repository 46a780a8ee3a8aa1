// SPDX-License-Identifier: Apache-2.0
// Joint filter over one channel's chain parameters and the state of the drive behind them, which wheel speeds measure
// (derivations.md, section 4).
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "slipwise/actuator/lane_motion.hpp"
#include "slipwise/estimate/drive_noise.hpp"
#include "slipwise/estimate/passage.hpp"
#include "slipwise/estimate/wheel_means.hpp"

namespace slipwise {

/// Log lag, log delay [ln s], gain, slow share [-], log slow lag [ln s].
inline constexpr Eigen::Index kChannelParameters = 5;

/// How a window of wheel speeds was foretold.
struct ChannelUpdate {
  double log_score = 0.0;  ///< log density of all its means under a Student t, without constants
  double nis = 0.0;        ///< of the means over the whole window, one per lane that moves
  Status status = Status::Converged;
};

/// State [parameters; per lane: fast part, slow part, deviation from the chain].
class ChainChannel {
 public:
  /// A window as it was learned.
  struct Past {
    InputTrack inputs;
    WheelMeans seen;
  };

  /// `parts` are the lanes that share the parameters, `noise` is a shape whose size is learned.
  ChainChannel(std::vector<double BodyTwist::*> parts, Estimate prior, const DriveNoise& noise,
               const IekfSettings& iekf);

  /// Learns a window. It goes on from the last one where it begins at its end; otherwise nothing is known of the drive.
  ChannelUpdate learn(const InputTrack& inputs, const WheelMeans& seen);
  /// Learns all windows so far anew from the prior, linearised at the parameters that all of them lead to together.
  void relearn(std::span<const Past> past);

  Estimate estimate() const;  ///< of the parameters
  /// Variance of one wheel speed's noise, as learned [(m/s)^2 or (rad/s)^2].
  double noise_variance() const { return size_; }

 private:
  struct Pass;

  Lane lane(const Eigen::VectorXd& state, std::size_t i) const;
  bool begin(const InputTrack& inputs, const WheelMeans& seen, const Eigen::VectorXd& chain);
  void lose_track();
  Passage foretell(const InputTrack& inputs, const WheelMeans& seen, const DriveNoiseMeans& noise,
                   const Eigen::VectorXd& state) const;
  Eigen::VectorXd foretell_values(const InputTrack& inputs, const WheelMeans& seen, const DriveNoiseMeans& noise,
                                  const Eigen::VectorXd& state) const;
  DriveNoiseMeans noise_means(const WheelMeans& seen) const;
  Eigen::VectorXd measured(const WheelMeans& seen) const;
  double mean_nis(const WheelMeans& seen, const Eigen::VectorXd& innovation, const Eigen::MatrixXd& covariance) const;
  double inflation(double nis, Eigen::Index count) const;
  void learn_size(const Eigen::VectorXd& innovation, const Eigen::LLT<Eigen::MatrixXd>& covariance,
                  const Eigen::MatrixXd& noise);
  using Values = std::function<Eigen::VectorXd(const Eigen::VectorXd& state)>;
  Eigen::MatrixXd bending(const Values& values, const PassagePoint& point) const;
  void carry_times(const Estimate& before);
  Pass pass(std::span<const Past> past, const Eigen::VectorXd& point) const;

  std::vector<double BodyTwist::*> parts_;
  std::vector<bool> live_;  ///< lanes of which something is known
  DriveNoise noise_;
  IekfSettings iekf_;
  Estimate prior_;
  Estimate joint_;
  double until_ = -std::numeric_limits<double>::infinity();  ///< [s]
  double size_;
  double windows_ = 0.0;
};

}  // namespace slipwise
