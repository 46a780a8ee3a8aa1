// SPDX-License-Identifier: Apache-2.0
// Window by window, and all windows at once where linearisations have moved.
#include "slipwise/estimate/chain_channel.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "slipwise/estimate/heavy_tails.hpp"
#include "slipwise/motion/motion_model.hpp"

namespace slipwise {
namespace {

constexpr double kSameStamp = 1e-6;                     // [s] windows closer than this meet
constexpr double kFirstSize = 0.1 * 0.1;                // [(m/s)^2, (rad/s)^2]
constexpr double kLeastSize = 1e-4 * 1e-4;              // nothing is computed or sampled more exactly
constexpr double kFirstWindows = 3.0, kMemory = 40.0;   // as in NoiseSettings
constexpr double kMostGain = 8.0;                       // of a window's noise over the expected
constexpr double kSlowRange = 0.3;                      // of the speed range, that the slow part may hold
constexpr double kStraight = 0.03, kUnknown = 1.0;      // as in iekf_update
constexpr double kSettled = 0.1;                        // in standard deviations
constexpr std::array<Eigen::Index, 3> kTimes{0, 1, 4};  // parameters that are logarithms of times
constexpr double kDegrees = 3.0;                        // of freedom that gate and Huber's bound are made for

Eigen::Index place(std::size_t lane) { return kChannelParameters + 3 * static_cast<Eigen::Index>(lane); }

/// -2 log density under a Student t, without constants.
double student_cost(double nis, const Eigen::LLT<Eigen::MatrixXd>& covariance) {
  const auto count = static_cast<double>(covariance.rows());
  const double log_det = 2.0 * covariance.matrixLLT().diagonal().array().log().sum();
  return log_det + (kTailDegrees + count) * std::log1p(nis / kTailDegrees);
}

/// The fastest that the lane was told to go, or went.
double fastest(const InputTrack& inputs, const WheelMeans& seen, const Lane& lane) {
  double speed = 0.0;
  for (const BodyTwist& twist : seen.twist) {
    speed = std::max(speed, std::abs(twist.*lane.part));
  }
  const std::size_t until = inputs.count_until(seen.edges.back());
  const std::size_t from = inputs.count_until(seen.edges.front() - lane.delay);
  for (std::size_t k = std::max<std::size_t>(from, 1) - 1; k < until; ++k) {
    speed = std::max(speed, std::abs(inputs.sample(k).*lane.part));
  }
  return speed;
}

}  // namespace

/// All windows learned about one point, and what they say of it.
struct ChainChannel::Pass {
  double cost;  ///< -2 log posterior of the point, exact but for weights of outliers
  ChainChannel learned;
};

ChainChannel::ChainChannel(std::vector<double BodyTwist::*> parts, Estimate prior, const DriveNoise& noise,
                           const IekfSettings& iekf)
    : parts_(std::move(parts)),
      live_(parts_.size(), false),
      noise_(noise),
      iekf_(iekf),
      prior_(std::move(prior)),
      size_(kFirstSize) {
  const Eigen::Index n = place(parts_.size());
  joint_ = {Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, n)};
  joint_.mean.head(kChannelParameters) = prior_.mean;
  joint_.covariance.topLeftCorner(kChannelParameters, kChannelParameters) = prior_.covariance;
}

Estimate ChainChannel::estimate() const {
  return {joint_.mean.head(kChannelParameters),
          joint_.covariance.topLeftCorner(kChannelParameters, kChannelParameters)};
}

Lane ChainChannel::lane(const Eigen::VectorXd& state, std::size_t i) const {
  return {parts_[i],
          {.gain = state[2], .lag = std::exp(state[0]), .slow_share = state[3], .slow_lag = std::exp(state[4])},
          std::exp(state[1])};
}

/// Makes the state that of the window's start; whether any lane moves. Of a lane that was not followed until here only
/// the range of its speeds is known. It is looked at through the chain of `chain`.
bool ChainChannel::begin(const InputTrack& inputs, const WheelMeans& seen, const Eigen::VectorXd& chain) {
  const double start = seen.edges.front();
  if (std::abs(start - until_) > kSameStamp) {
    lose_track();
  }
  until_ = seen.edges.back();
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (live_[i]) {
      continue;
    }
    const double range = fastest(inputs, seen, lane(chain, i));
    live_[i] = range > 0.0;
    if (live_[i]) {
      const LaneState settled = settled_lane(inputs, lane(chain, i), start);
      joint_.mean.segment<3>(place(i)) << settled.fast, settled.slow, 0.0;
      joint_.covariance.diagonal().segment<3>(place(i)) << range * range, std::pow(kSlowRange * range, 2),
          noise_.wander * size_;
    }
  }
  return std::ranges::find(live_, true) != live_.end();
}

void ChainChannel::lose_track() {
  live_.assign(live_.size(), false);
  const Eigen::Index states = joint_.mean.size() - kChannelParameters;
  joint_.mean.tail(states).setZero();
  joint_.covariance.bottomRows(states).setZero();
  joint_.covariance.rightCols(states).setZero();
}

DriveNoiseMeans ChainChannel::noise_means(const WheelMeans& seen) const {
  return drive_noise_means(noise_, seen.edges, seen.samples);
}

Passage ChainChannel::foretell(const InputTrack& inputs, const WheelMeans& seen, const DriveNoiseMeans& noise,
                               const Eigen::VectorXd& state) const {
  const auto k = std::ssize(seen.samples);
  const Eigen::Index n = state.size();
  const Eigen::Index m = std::ranges::count(live_, true) * k;
  Passage passage{.measured = m,
                  .value = Eigen::VectorXd::Zero(m + n),
                  .slope = Eigen::MatrixXd::Zero(m + n, n),
                  .noise = Eigen::MatrixXd::Zero(m + n, m + n)};
  passage.value.segment(m, kChannelParameters) = state.head(kChannelParameters);
  passage.slope.block(m, 0, kChannelParameters, kChannelParameters).setIdentity();
  Eigen::Index from = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (!live_[i]) {
      continue;
    }
    const Lane its = lane(state, i);
    const Eigen::Index own = place(i);
    LaneMotion motion = lane_motion(inputs, its, {.fast = state[own], .slow = state[own + 1]}, seen.edges);
    motion.slope.col(0) *= its.response.lag;  // by the logarithms
    motion.slope.col(1) *= its.delay;
    motion.slope.col(4) *= its.response.slow_lag;
    const auto chain_rows = Eigen::seqN(from, k);
    const auto end_rows = Eigen::seqN(m + own, 2);
    passage.value(chain_rows) = motion.value.head(k) + noise.by_start.head(k) * state[own + 2];
    passage.value(end_rows) = motion.value.tail<2>();
    passage.slope(chain_rows, Eigen::seqN(0, kChannelParameters)) = motion.slope.topLeftCorner(k, kChannelParameters);
    passage.slope(end_rows, Eigen::seqN(0, kChannelParameters)) =
        motion.slope.bottomLeftCorner<2, kChannelParameters>();
    passage.slope(chain_rows, Eigen::seqN(own, 2)) = motion.slope.topRightCorner(k, 2);
    passage.slope(end_rows, Eigen::seqN(own, 2)) = motion.slope.bottomRightCorner<2, 2>();
    passage.slope(chain_rows, own + 2) = noise.by_start.head(k);
    const Eigen::Index deviation = m + own + 2;
    passage.value[deviation] = noise.by_start[k] * state[own + 2];
    passage.slope(deviation, own + 2) = noise.by_start[k];
    passage.noise(chain_rows, chain_rows) = size_ * noise.covariance.topLeftCorner(k, k);
    passage.noise(chain_rows, deviation) = size_ * noise.covariance.col(k).head(k);
    passage.noise(deviation, chain_rows) = passage.noise(chain_rows, deviation).transpose();
    passage.noise(deviation, deviation) = size_ * noise.covariance(k, k);
    from += k;
  }
  return passage;
}

/// The value of what `foretell` returns.
Eigen::VectorXd ChainChannel::foretell_values(const InputTrack& inputs, const WheelMeans& seen,
                                              const DriveNoiseMeans& noise, const Eigen::VectorXd& state) const {
  const auto k = std::ssize(seen.samples);
  const Eigen::Index m = std::ranges::count(live_, true) * k;
  Eigen::VectorXd value = Eigen::VectorXd::Zero(m + state.size());
  value.segment(m, kChannelParameters) = state.head(kChannelParameters);
  Eigen::Index from = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (!live_[i]) {
      continue;
    }
    const Eigen::Index own = place(i);
    const Eigen::VectorXd motion =
        lane_values(inputs, lane(state, i), {.fast = state[own], .slow = state[own + 1]}, seen.edges);
    value.segment(from, k) = motion.head(k) + noise.by_start.head(k) * state[own + 2];
    value.segment<2>(m + own) = motion.tail<2>();
    value[m + own + 2] = noise.by_start[k] * state[own + 2];
    from += k;
  }
  return value;
}

Eigen::VectorXd ChainChannel::measured(const WheelMeans& seen) const {
  Eigen::VectorXd means(std::ranges::count(live_, true) * std::ssize(seen.twist));
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    for (std::size_t k = 0; live_[i] && k < seen.twist.size(); ++k) {
      means[row++] = seen.twist[k].*parts_[i];
    }
  }
  return means;
}

/// Of the means over the whole window, lane after lane.
double ChainChannel::mean_nis(const WheelMeans& seen, const Eigen::VectorXd& innovation,
                              const Eigen::MatrixXd& covariance) const {
  const auto k = std::ssize(seen.samples);
  const Eigen::Index lanes = innovation.size() / k;
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(lanes, innovation.size());
  for (Eigen::Index i = 0; i < lanes; ++i) {
    for (std::size_t j = 0; j < seen.samples.size(); ++j) {
      mean(i, i * k + static_cast<Eigen::Index>(j)) = seen.edges[j + 1] - seen.edges[j];
    }
  }
  const Eigen::VectorXd error = mean * innovation;
  return error.dot((mean * covariance * mean.transpose()).llt().solve(error));
}

/// By how much the noise of a window is larger than usual, by the rule of the IEKF; none where it is left out.
double ChainChannel::inflation(double nis, Eigen::Index count) const {
  const double per_degrees = kDegrees * nis / static_cast<double>(count);
  if (!(per_degrees <= iekf_.gate)) {
    return 0.0;
  }
  return std::max(std::sqrt(per_degrees) / iekf_.huber, 1.0);
}

/// One step of expectation-maximisation for the size of the noise, given its shape: what of the innovation is noise.
void ChainChannel::learn_size(const Eigen::VectorXd& innovation, const Eigen::LLT<Eigen::MatrixXd>& covariance,
                              const Eigen::MatrixXd& noise) {
  const Eigen::VectorXd whitened = covariance.solve(innovation);
  const double surprise = whitened.dot(noise * whitened) - covariance.solve(noise).trace();
  windows_ += 1.0;
  const double gain = std::max(1.0 / (windows_ + kFirstWindows), 1.0 / kMemory);
  size_ *= 1.0 + gain * std::min(surprise / static_cast<double>(innovation.size()), kMostGain);
  size_ = std::max(size_, kLeastSize);
}

/// As in iekf_update: how far the window bends away over what is left open of the parameters.
Eigen::MatrixXd ChainChannel::bending(const Values& values, const PassagePoint& point) const {
  const Eigen::MatrixXd left = start_covariance(joint_, point.at);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> open(left.topLeftCorner(kChannelParameters, kChannelParameters));
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(point.at.value.size(), point.at.value.size());
  for (Eigen::Index i = 0; i < kChannelParameters; ++i) {
    const double std = std::sqrt(std::max(open.eigenvalues()[i], 0.0));
    if (std < kStraight) {
      continue;
    }
    const Eigen::VectorXd step = left.leftCols(kChannelParameters) * open.eigenvectors().col(i) / std;
    const Eigen::VectorXd second = (values(point.state + step) + values(point.state - step)) / 2.0 - point.at.value;
    spread += 2.0 * second * second.transpose();
  }
  return spread;
}

/// As in iekf_update: covariances are carried in coordinates in which times act evenly.
void ChainChannel::carry_times(const Estimate& before) {
  for (const Eigen::Index i : kTimes) {
    const double most = std::max(kUnknown / std::sqrt(joint_.covariance(i, i)), 1.0);
    const double carry = std::min(even_slope(std::exp(before.mean[i])) / even_slope(std::exp(joint_.mean[i])), most);
    joint_.covariance.row(i) *= carry;
    joint_.covariance.col(i) *= carry;
  }
}

ChannelUpdate ChainChannel::learn(const InputTrack& inputs, const WheelMeans& seen) {
  if (!begin(inputs, seen, joint_.mean)) {
    return {};
  }
  const Eigen::VectorXd z = measured(seen);
  const DriveNoiseMeans noise = noise_means(seen);
  Passage expected = foretell(inputs, seen, noise, joint_.mean);
  const Eigen::VectorXd innovation = z - expected.seen();
  const Eigen::MatrixXd s = innovation_covariance(joint_, expected);
  const Eigen::LLT<Eigen::MatrixXd> s_llt(s);
  const double nis = innovation.dot(s_llt.solve(innovation));
  ChannelUpdate update{.log_score = -0.5 * student_cost(nis, s_llt), .nis = mean_nis(seen, innovation, s)};
  const double larger = inflation(nis, z.size());
  const Eigen::MatrixXd usual = expected.seen_noise();
  const Foretell weighed = [&](const Eigen::VectorXd& state) {
    Passage passage = foretell(inputs, seen, noise, state);
    passage.noise *= larger;
    return passage;
  };
  const Values values = [&](const Eigen::VectorXd& state) { return foretell_values(inputs, seen, noise, state); };
  if (larger > 0.0) {
    update.status = larger > 1.0 ? Status::Downweighted : Status::Converged;
    expected.noise *= larger;
    PassagePoint point = settle(joint_, std::move(expected), weighed, z, iekf_);
    point.at.noise += bending(values, point);
    const Estimate before = joint_;
    joint_ = end_estimate(before, point, z);
    carry_times(before);
  } else {
    update.status = Status::Rejected;
    lose_track();
  }
  learn_size(innovation, s_llt, usual);
  return update;
}

/// For given parameters the chain is linear in its state: `known` follows it exactly, and its likelihood is that of the
/// parameters. The joint filter is linearised along it.
ChainChannel::Pass ChainChannel::pass(std::span<const Past> past, const Eigen::VectorXd& point) const {
  ChainChannel learned(parts_, prior_, noise_, iekf_);
  ChainChannel known(parts_, {point, Eigen::MatrixXd::Zero(kChannelParameters, kChannelParameters)}, noise_, iekf_);
  learned.size_ = known.size_ = size_;
  learned.windows_ = windows_;
  const Eigen::VectorXd away = (point - prior_.mean).cwiseQuotient(prior_.covariance.diagonal().cwiseSqrt());
  double cost = away.squaredNorm();
  for (const Past& window : past) {
    learned.begin(window.inputs, window.seen, known.joint_.mean);
    if (!known.begin(window.inputs, window.seen, known.joint_.mean)) {
      continue;
    }
    const Eigen::VectorXd z = known.measured(window.seen);
    const DriveNoiseMeans noise = noise_means(window.seen);
    PassagePoint along{known.joint_.mean, known.foretell(window.inputs, window.seen, noise, known.joint_.mean)};
    const Eigen::LLT<Eigen::MatrixXd> s(innovation_covariance(known.joint_, along.at));
    const double nis = (z - along.at.seen()).dot(s.solve(z - along.at.seen()));
    cost += student_cost(nis, s);
    if (const double larger = known.inflation(nis, z.size()); larger > 0.0) {
      along.at.noise *= larger;
      learned.joint_ = end_estimate(learned.joint_, along, z);
      known.joint_ = end_estimate(known.joint_, along, z);
    } else {
      learned.lose_track();
      known.lose_track();
    }
  }
  return {cost, std::move(learned)};
}

void ChainChannel::relearn(std::span<const Past> past) {
  Eigen::VectorXd point = joint_.mean.head(kChannelParameters);
  Pass best = pass(past, point);
  for (int i = 0; i < iekf_.iterations; ++i) {
    const Estimate led = best.learned.estimate();
    const Eigen::VectorXd full = led.mean - point;
    if ((full.cwiseAbs() - kSettled * led.covariance.diagonal().cwiseSqrt()).maxCoeff() <= 0.0) {
      break;
    }
    bool better = false;
    double share = 1.0;
    for (int halvings = iekf_.halvings; halvings >= 0 && !better; --halvings, share /= 2.0) {
      Pass next = pass(past, point + share * full);
      better = std::isfinite(next.cost) && next.cost <= best.cost;
      if (better) {
        point += share * full;
        best = std::move(next);
      }
    }
    if (!better) {
      break;
    }
  }
  *this = std::move(best.learned);
}

}  // namespace slipwise
