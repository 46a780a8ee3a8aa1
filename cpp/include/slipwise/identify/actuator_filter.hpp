// SPDX-License-Identifier: Apache-2.0
// The actuator learned from commands and wheel speeds, under several guesses of what else moves the wheels.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "slipwise/filter/causal_filter.hpp"
#include "slipwise/filter/hypothesis_bank.hpp"
#include "slipwise/identify/actuator_channel.hpp"
#include "slipwise/identify/channel_refit.hpp"

namespace slipwise {

/// How a window of wheel speeds was predicted by the actuator and white noise alone.
struct ActuatorUpdate {
  double nis;  ///< of the mean of speed, sideways speed and yaw rate over the window: of those that move
};

/// Speed and yaw rate are independent. For each, filters with different shapes of noise learn side by side, weighted by
/// how well they predict the wheels; the posterior is their mixture.
class ActuatorFilter {
 public:
  /// Priors, gate and Huber's bound are those of `settings`. Where `waiting` windows are at hand already, no refit
  /// begins before they are all learned.
  explicit ActuatorFilter(const CausalFilterSettings& settings, std::size_t waiting = 0);
  ActuatorFilter(const ActuatorFilter&);
  ActuatorFilter(ActuatorFilter&&) noexcept;
  ActuatorFilter& operator=(const ActuatorFilter&);
  ActuatorFilter& operator=(ActuatorFilter&&) noexcept;
  ~ActuatorFilter();

  /// Begins with what was learned before, in the parameters of `model`.
  void begin_with(const Estimate& known, const CausalFilterSettings& settings);

  /// Learns the wheel speeds from `start` to `end` [s], in input stamps. Nothing later is used.
  /// \throws std::invalid_argument when the end is not after the start.
  /// After 3, 4, 5, 7, ... 256 windows a refit of all of them begins, which takes effect a thirty-second as many
  /// windows later.
  ActuatorUpdate learn(const InputHistory& inputs, const InputHistory& wheels, double start, double end);
  /// Does a bounded slice of the refit's work; whether there was any to do. Results do not depend on it.
  bool refit_slice();
  /// A refit that is under way takes effect now.
  void end_refit();

  const MotionModel& model() const { return model_; }  ///< the actuator alone
  Estimate estimate() const;
  const Eigen::VectorXd& prior_std() const { return prior_std_; }

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const ActuatorFilter& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.model_, self.prior_std_, self.banks_, self.learned_, self.next_, self.refitted_after_, self.past_);
  }

 private:
  struct Bank {
    std::vector<Eigen::Index> places;  ///< of its parameters among the model's
    HypothesisBank<ActuatorChannel> candidates;
    std::vector<std::optional<ChannelRefit>> refits;  ///< of the candidates; none of those without weight

    double learn(const ChannelWindow& window);
    void begin_refit(std::size_t windows);
    bool refit_slice(std::span<const ChannelWindow> past);
    void end_refit();
    Estimate mixture() const;
  };

  MotionModel model_;
  Eigen::VectorXd prior_std_;
  std::vector<Bank> banks_;
  std::size_t learned_ = 0;
  std::size_t next_;                           ///< windows after which a refit begins
  std::optional<std::size_t> refitted_after_;  ///< windows after which the one under way takes effect
  std::vector<ChannelWindow> past_;
};

}  // namespace slipwise
