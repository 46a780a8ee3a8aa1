// SPDX-License-Identifier: Apache-2.0
// The chain learned from commands and wheel speeds, under several guesses of what else moves the wheels.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "slipwise/estimate/causal_filter.hpp"
#include "slipwise/estimate/chain_channel.hpp"
#include "slipwise/estimate/weighing.hpp"

namespace slipwise {

/// How a window of wheel speeds was foretold by the chain and white noise alone.
struct ChainUpdate {
  double nis;  ///< of the mean of speed, sideways speed and yaw rate over the window: of those that move
};

/// Speed and yaw rate are independent. For each, filters with different shapes of noise learn side by side, weighed by
/// how well they foretell the wheels; the belief is their mixture.
class ChainLearner {
 public:
  /// Priors, gate and Huber's bound are those of `settings`. Where `waiting` windows are at hand already, nothing is
  /// learned anew before they are all learned.
  explicit ChainLearner(const CausalFilterSettings& settings, std::size_t waiting = 0);

  /// Learns the wheel speeds from `start` to `end` [s], in input stamps. Nothing later is used.
  /// \throws std::invalid_argument when the end is not after the start.
  ChainUpdate learn(const InputTrack& inputs, const InputTrack& wheels, double start, double end);

  const MotionModel& model() const { return model_; }  ///< the chain alone
  Estimate estimate() const;
  const Eigen::VectorXd& prior_std() const { return prior_std_; }

 private:
  struct Bank {
    std::vector<Eigen::Index> places;  ///< of its parameters among the model's
    std::vector<ChainChannel> rivals;
    Eigen::VectorXd weights;

    double learn(const ChannelWindow& window, std::size_t learned);
    void relearn(std::span<const ChannelWindow> past);
    Estimate mixture() const;
  };

  MotionModel model_;
  Eigen::VectorXd prior_std_;
  std::vector<Bank> banks_;
  std::size_t learned_ = 0;
  std::size_t next_;  ///< windows after which all are learned anew
  std::vector<ChannelWindow> past_;
};

}  // namespace slipwise
