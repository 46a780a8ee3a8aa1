// SPDX-License-Identifier: Apache-2.0
// Joint filter over one channel's actuator parameters and the state of the drive behind them, which wheel speeds
// measure (derivations/actuator.md).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <vector>

#include "slipwise/filter/window_model.hpp"
#include "slipwise/identify/channel_run.hpp"
#include "slipwise/linear/cholesky.hpp"

namespace slipwise {

/// How a window of wheel speeds was predicted.
struct ChannelUpdate {
  double log_score = 0.0;  ///< log density of all its means under a Student t, without constants
  double nis = 0.0;        ///< of the means over the whole window, one per axis that moves
  Status status = Status::Converged;
};

/// State [parameters; per axis that is followed: fast mode, slow mode, deviation from the actuator].
class ActuatorChannel {
 public:
  ActuatorChannel() = default;
  explicit ActuatorChannel(ChannelModel model);

  /// Learns a window. It goes on from the last one where it begins at its end; otherwise nothing is known of the drive.
  ChannelUpdate learn(const ChannelWindow& window, bool carefully = true);
  /// Takes over what a refit found, and has learned since.
  void take(ChannelRun found);
  const ChannelModel& model() const { return model_; }

  Estimate estimate() const;  ///< of the parameters
  /// Variance of one wheel speed's noise, as learned [(m/s)^2 or (rad/s)^2].
  double noise_variance() const { return size_; }

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const ActuatorChannel& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.model_, self.live_, self.joint_, self.until_, self.size_, self.windows_);
  }

 private:
  ActuatorAxis axis(const Eigen::VectorXd& state, std::size_t i) const;
  bool begin(const ChannelWindow& window);
  void lose_state();
  WindowModel predict(const ChannelWindow& window, const ActuatorNoiseMeans& noise, const Eigen::VectorXd& state) const;
  Eigen::VectorXd predict_values(const ChannelWindow& window, const ActuatorNoiseMeans& noise,
                                 const Eigen::VectorXd& state) const;
  Eigen::VectorXd measured(const WheelMeans& observed) const;
  double mean_nis(const WheelMeans& observed, const Eigen::VectorXd& innovation,
                  const Eigen::MatrixXd& covariance) const;
  void learn_size(const Eigen::VectorXd& innovation, const Cholesky& covariance, const Eigen::MatrixXd& noise);
  using Values = std::function<Eigen::VectorXd(const Eigen::VectorXd& state)>;
  Eigen::MatrixXd second_order(const Values& values, const WindowPoint& point) const;
  void reparametrise_times(const Estimate& before);

  ChannelModel model_;
  std::vector<std::size_t> live_;  ///< axes that are followed, by their places among the parts
  Estimate joint_;
  double until_ = -std::numeric_limits<double>::infinity();  ///< [s]
  double size_ = 0.0;
  double windows_ = 0.0;
};

}  // namespace slipwise
