// SPDX-License-Identifier: Apache-2.0
// Window by window, and all windows at once where linearisations have moved.
#include "slipwise/identify/actuator_channel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/linear/symmetric_eigen.hpp"
#include "slipwise/linear/tuning.hpp"
#include "slipwise/motion/motion_model.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kFirstSize, 0.1 * 0.1);     // [(m/s)^2, (rad/s)^2]
constexpr double kLeastSize = 1e-4 * 1e-4;  // nothing is computed or sampled more exactly
SLIPWISE_TUNING(kFirstWindows, 3.0);        // as in NoiseSettings
SLIPWISE_TUNING(kMemory, 40.0);
SLIPWISE_TUNING(kMostGain, 8.0);   // of a window's noise over the expected
SLIPWISE_TUNING(kStraight, 0.03);  // as in iekf_update
SLIPWISE_TUNING(kUnknown, 1.0);
constexpr std::array kTimes{kTimeConstant, kDelay, kSlowTimeConstant};  // parameters that are logarithms of times

/// Of the state of the axis that is followed as the i-th.
Eigen::Index place(std::size_t i) { return kChannelParameters + kAxisStates * static_cast<Eigen::Index>(i); }

}  // namespace

ActuatorChannel::ActuatorChannel(ChannelModel model)
    : model_(std::move(model)), joint_(model_.prior), size_(kFirstSize) {}

Estimate ActuatorChannel::estimate() const {
  return {joint_.mean.head(kChannelParameters),
          joint_.covariance.topLeftCorner(kChannelParameters, kChannelParameters)};
}

ActuatorAxis ActuatorChannel::axis(const Eigen::VectorXd& state, std::size_t i) const {
  return axis_of(model_.parts[live_[i]], state.head<kChannelParameters>());
}

/// Makes the state that of the window's start; whether any axis moves.
bool ActuatorChannel::begin(const ChannelWindow& window) {
  if (!same_stamp(window.observed.edges.front(), until_)) {
    lose_state();
  }
  until_ = window.observed.edges.back();
  for (std::size_t i = 0; i < model_.parts.size(); ++i) {
    if (std::ranges::find(live_, i) != live_.end()) {
      continue;
    }
    const ActuatorAxis its = axis_of(model_.parts[i], joint_.mean.head<kChannelParameters>());
    if (const auto first = first_state(window, its, model_.noise.deviation * size_)) {
      live_.push_back(i);
      const Eigen::Index n = joint_.mean.size() + kAxisStates;
      joint_.mean.conservativeResize(n);
      joint_.mean.tail<kAxisStates>() = first->mean;
      joint_.covariance.conservativeResizeLike(Eigen::MatrixXd::Zero(n, n));
      joint_.covariance.diagonal().tail<kAxisStates>() = first->variance;
    }
  }
  return !live_.empty();
}

void ActuatorChannel::lose_state() {
  live_.clear();
  joint_ = estimate();
}

WindowModel ActuatorChannel::predict(const ChannelWindow& window, const ActuatorNoiseMeans& noise,
                                     const Eigen::VectorXd& state) const {
  const auto k = std::ssize(window.observed.samples);
  const Eigen::Index n = state.size();
  const Eigen::Index m = std::ssize(live_) * k;
  WindowModel model{.measured = m,
                    .value = Eigen::VectorXd::Zero(m + n),
                    .derivative = Eigen::MatrixXd::Zero(m + n, n),
                    .noise = Eigen::MatrixXd::Zero(m + n, m + n)};
  model.value.segment(m, kChannelParameters) = state.head(kChannelParameters);
  model.derivative.block(m, 0, kChannelParameters, kChannelParameters).setIdentity();
  for (std::size_t i = 0; i < live_.size(); ++i) {
    const Eigen::Index own = place(i);
    const AxisWindow its = axis_window(window, axis(state, i), state.segment<kAxisStates>(own), noise);
    const Eigen::Index from = static_cast<Eigen::Index>(i) * k;
    const Eigen::Index end = m + own;
    const Eigen::Index deviation = end + 2;
    model.value.segment(from, k) = its.value.head(k);
    model.value.segment<kAxisStates>(end) = its.value.tail<kAxisStates>();
    model.derivative.block(from, 0, k, kChannelParameters) = its.by_actuator.topRows(k);
    model.derivative.block(end, 0, kAxisStates, kChannelParameters) = its.by_actuator.bottomRows<kAxisStates>();
    model.derivative.block(from, own, k, kAxisStates) = its.by_state.topRows(k);
    model.derivative.block(end, own, kAxisStates, kAxisStates) = its.by_state.bottomRows<kAxisStates>();
    model.noise.block(from, from, k, k) = size_ * noise.covariance.topLeftCorner(k, k);
    model.noise.col(deviation).segment(from, k) = size_ * noise.covariance.col(k).head(k);
    model.noise.row(deviation).segment(from, k) = model.noise.col(deviation).segment(from, k).transpose();
    model.noise(deviation, deviation) = size_ * noise.covariance(k, k);
  }
  return model;
}

/// The value of what `predict` returns.
Eigen::VectorXd ActuatorChannel::predict_values(const ChannelWindow& window, const ActuatorNoiseMeans& noise,
                                                const Eigen::VectorXd& state) const {
  const auto k = std::ssize(window.observed.samples);
  const Eigen::Index m = std::ssize(live_) * k;
  Eigen::VectorXd value(m + state.size());
  value.segment(m, kChannelParameters) = state.head(kChannelParameters);
  for (std::size_t i = 0; i < live_.size(); ++i) {
    const Eigen::Index own = place(i);
    const AxisState start{.fast = state[own], .slow = state[own + 1]};
    const Eigen::VectorXd motion = axis_values(window.inputs, axis(state, i), start, window.observed.edges);
    value.segment(static_cast<Eigen::Index>(i) * k, k) = motion.head(k) + noise.by_start.head(k) * state[own + 2];
    value.segment<2>(m + own) = motion.tail<2>();
    value[m + own + 2] = noise.by_start[k] * state[own + 2];
  }
  return value;
}

/// What was measured, axis after axis.
Eigen::VectorXd ActuatorChannel::measured(const WheelMeans& observed) const {
  const auto k = std::ssize(observed.samples);
  Eigen::VectorXd means(std::ssize(live_) * k);
  for (std::size_t i = 0; i < live_.size(); ++i) {
    means.segment(static_cast<Eigen::Index>(i) * k, k) = axis_means(observed, axis(joint_.mean, i));
  }
  return means;
}

/// Of the means over the whole window, axis after axis.
double ActuatorChannel::mean_nis(const WheelMeans& observed, const Eigen::VectorXd& innovation,
                                 const Eigen::MatrixXd& covariance) const {
  const auto k = std::ssize(observed.samples);
  const Eigen::Index axes = innovation.size() / k;
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(axes, innovation.size());
  for (Eigen::Index i = 0; i < axes; ++i) {
    for (std::size_t j = 0; j < observed.samples.size(); ++j) {
      mean(i, i * k + static_cast<Eigen::Index>(j)) = observed.edges[j + 1] - observed.edges[j];
    }
  }
  const Eigen::VectorXd error = mean * innovation;
  return error.dot(Cholesky(mean * covariance * mean.transpose()).solve(error));
}

/// One step of expectation-maximisation for the size of the noise, given its shape: what of the innovation is noise.
void ActuatorChannel::learn_size(const Eigen::VectorXd& innovation, const Cholesky& covariance,
                                 const Eigen::MatrixXd& noise) {
  const Eigen::VectorXd whitened = covariance.solve(innovation);
  const double surprise = whitened.dot(noise * whitened) - covariance.solve(noise).trace();
  windows_ += 1.0;
  const double gain = std::max(1.0 / (windows_ + kFirstWindows), 1.0 / kMemory);
  size_ *= 1.0 + gain * std::min(surprise / static_cast<double>(innovation.size()), kMostGain);
  size_ = std::max(size_, kLeastSize);
}

/// As in iekf_update: how far the window bends away over the open part of the parameters.
Eigen::MatrixXd ActuatorChannel::second_order(const Values& values, const WindowPoint& point) const {
  const Eigen::MatrixXd left = start_covariance(joint_, point.at);
  const SymmetricEigen open = symmetric_eigen(left.topLeftCorner(kChannelParameters, kChannelParameters));
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(point.at.value.size(), point.at.value.size());
  for (Eigen::Index i = 0; i < kChannelParameters; ++i) {
    const double std = std::sqrt(std::max(open.values[i], 0.0));
    if (std < kStraight) {
      continue;
    }
    const Eigen::VectorXd step = left.leftCols(kChannelParameters) * open.vectors.col(i) / std;
    const Eigen::VectorXd second = (values(point.state + step) + values(point.state - step)) / 2.0 - point.at.value;
    spread += 2.0 * second * second.transpose();
  }
  return spread;
}

/// As in iekf_update: covariances are carried in coordinates in which times act evenly.
void ActuatorChannel::reparametrise_times(const Estimate& before) {
  for (const Eigen::Index i : kTimes) {
    const double most = std::max(kUnknown / std::sqrt(joint_.covariance(i, i)), 1.0);
    const double reparametrised =
        std::min(log_time_derivative(std::exp(before.mean[i])) / log_time_derivative(std::exp(joint_.mean[i])), most);
    joint_.covariance.row(i) *= reparametrised;
    joint_.covariance.col(i) *= reparametrised;
  }
}

ChannelUpdate ActuatorChannel::learn(const ChannelWindow& window, bool carefully) {
  if (!begin(window)) {
    return {};
  }
  const WheelMeans& observed = window.observed;
  const Eigen::VectorXd z = measured(observed);
  const ActuatorNoiseMeans noise = actuator_noise_means(model_.noise, observed.edges, observed.samples);
  WindowModel expected = predict(window, noise, joint_.mean);
  const Eigen::VectorXd innovation = z - expected.observed();
  const Eigen::MatrixXd s = innovation_covariance(joint_, expected);
  const Cholesky s_llt(s);
  const double nis = innovation.dot(s_llt.solve(innovation));
  const double log_determinant = s_llt.log_determinant();
  ChannelUpdate update{.log_score = -0.5 * student_cost(nis, log_determinant, z.size()),
                       .nis = mean_nis(observed, innovation, s)};
  const double larger = noise_inflation(nis, z.size(), model_.iekf);
  const Eigen::MatrixXd nominal = expected.observed_noise();
  const MeasurementFunction weighted = [&](const Eigen::VectorXd& state) {
    WindowModel model = predict(window, noise, state);
    model.noise *= larger;
    return model;
  };
  const Values values = [&](const Eigen::VectorXd& state) { return predict_values(window, noise, state); };
  if (larger > 0.0) {
    update.status = larger > 1.0 ? Status::Downweighted : Status::Converged;
    expected.noise *= larger;
    WindowPoint point{joint_.mean, std::move(expected)};
    if (carefully) {
      point = most_probable_start(joint_, std::move(point.at), weighted, z, model_.iekf);
      point.at.noise += second_order(values, point);
    }
    const Estimate before = joint_;
    joint_ = end_estimate(before, point, z);
    reparametrise_times(before);
  } else {
    update.status = Status::Rejected;
    lose_state();
  }
  learn_size(innovation, s_llt, nominal);
  return update;
}

void ActuatorChannel::take(ChannelRun found) {
  joint_ = std::move(found.joint);
  live_ = std::move(found.live);
  until_ = found.until;
}

}  // namespace slipwise
