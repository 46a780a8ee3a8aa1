// SPDX-License-Identifier: Apache-2.0
// Filters of the lanes' states alone, which carry their derivatives by the chain along.
#include "slipwise/estimate/chain_pass.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/estimate/heavy_tails.hpp"
#include "slipwise/linear/cholesky.hpp"

namespace slipwise {
namespace {

constexpr double kDegrees = 3.0;  // of freedom that gate and Huber's bound are made for

using Information = Eigen::Matrix<double, kChannelParameters, kChannelParameters>;
using StateByChain = Eigen::Matrix<double, kLaneStates, kChannelParameters>;
using LaneCovariance = Eigen::Matrix<double, kLaneStates, kLaneStates>;
constexpr Eigen::Index kDeviation = 2;  // among the lane's states
constexpr std::array kTwist{&BodyTwist::v, &BodyTwist::vy, &BodyTwist::omega};

}  // namespace

/// A lane that has learned the means of a window, and what these tell of the parameters.
struct ChannelWalk::Learned {
  FollowedLane lane;
  double nis = 0.0;
  double log_determinant = 0.0;
  Information information = Information::Zero();
  ChannelParameters gradient = ChannelParameters::Zero();
};

std::vector<std::size_t> places_in_twist(const std::vector<double BodyTwist::*>& parts) {
  std::vector<std::size_t> places;
  for (const auto part : parts) {
    places.push_back(static_cast<std::size_t>(std::ranges::find(kTwist, part) - kTwist.begin()));
  }
  return places;
}

std::vector<double BodyTwist::*> parts_of_twist(const std::vector<std::size_t>& places) {
  std::vector<double BodyTwist::*> parts;
  for (const std::size_t place : places) {
    if (place >= kTwist.size()) {
      throw std::invalid_argument("a twist has no place " + std::to_string(place));
    }
    parts.push_back(kTwist[place]);
  }
  return parts;
}

ChannelWalk::ChannelWalk(std::shared_ptr<const ChannelModel> model, double size, const ChannelParameters& point)
    : model_(std::move(model)), size_(size), point_(point) {
  const Estimate& prior = model_->prior;
  const Eigen::VectorXd away = point - prior.mean;
  cost_ = away.cwiseQuotient(prior.covariance.diagonal().cwiseSqrt()).squaredNorm();
  information_ = Cholesky(prior.covariance).inverse();
  gradient_ = -information_ * away;
}

void ChannelWalk::learn(const ChannelWindow& window) {
  begin(window);
  if (lanes_.empty()) {
    return;
  }
  std::vector<AxisMotion> motions;
  std::vector<Learned> learned;
  double nis = 0.0;
  double log_determinant = 0.0;
  for (const FollowedLane& lane : lanes_) {
    const ActuatorAxis axis = lane_of(model_->parts[lane.place], point_);
    motions.push_back(lane_through(window, axis, {.fast = lane.mean[0], .slow = lane.mean[1]}));
    learned.push_back(filter(lane, motions.back(), window.seen, size_));
    nis += learned.back().nis;
    log_determinant += learned.back().log_determinant;
  }
  const Eigen::Index count = std::ssize(lanes_) * std::ssize(window.seen.twist);
  cost_ += student_cost(nis, log_determinant, count);
  const double larger = noise_inflation(nis, count, model_->iekf);
  if (!(larger > 0.0)) {
    lanes_.clear();
    return;
  }
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    const Learned taken = larger > 1.0 ? filter(lanes_[i], motions[i], window.seen, larger * size_) : learned[i];
    information_ += taken.information;
    gradient_ += taken.gradient;
    lanes_[i] = taken.lane;
  }
}

void ChannelWalk::begin(const ChannelWindow& window) {
  if (std::abs(window.seen.edges.front() - until_) > kSameStamp) {
    lanes_.clear();
  }
  until_ = window.seen.edges.back();
  for (std::size_t i = 0; i < model_->parts.size(); ++i) {
    if (std::ranges::find(lanes_, i, &FollowedLane::place) != lanes_.end()) {
      continue;
    }
    if (const auto first = first_state(window, lane_of(model_->parts[i], point_), model_->noise.wander * size_)) {
      lanes_.push_back({i, first->mean, first->variance.asDiagonal(), StateByChain::Zero()});
    }
  }
}

/// The Kalman filter and its derivative, one mean after the other. Its state are the fast and the slow part at the
/// window's start, from where they were thought to be, and the deviation now.
ChannelWalk::Learned ChannelWalk::filter(const FollowedLane& lane, const AxisMotion& motion, const WheelMeans& seen,
                                         double size) const {
  Learned learned{.lane = lane};
  auto& [place, mean, covariance, by_chain] = learned.lane;
  mean.head<kDeviation>().setZero();
  const auto k = std::ssize(seen.twist);
  for (Eigen::Index i = 0; i < k; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const DriveNoiseInterval noise =
        drive_noise_interval(model_->noise, seen.edges[at + 1] - seen.edges[at], seen.samples[at]);
    const LaneVector h(motion.slope(i, 5), motion.slope(i, 6), noise.mean);
    const double innovation = seen.twist[at].*model_->parts[place] - motion.value[i] - h.dot(mean);
    const ChannelParameters moved =
        motion.slope.row(i).head<kChannelParameters>().transpose() + by_chain.transpose() * h;
    LaneVector cross = covariance * h;
    const double variance = h.dot(cross) + size * noise.of_mean;
    learned.nis += innovation * innovation / variance;
    learned.log_determinant += std::log(variance);
    learned.information += moved * moved.transpose() / variance;
    learned.gradient += moved * (innovation / variance);
    const LaneVector kept(1.0, 1.0, noise.kept);  // until the interval's end
    cross = kept.cwiseProduct(cross);
    cross[kDeviation] += size * noise.crossed;
    mean = kept.cwiseProduct(mean) + cross * (innovation / variance);
    by_chain = kept.asDiagonal() * by_chain - cross / variance * moved.transpose();
    covariance = (kept.asDiagonal() * covariance * kept.asDiagonal() - cross * cross.transpose() / variance).eval();
    covariance(kDeviation, kDeviation) += size * noise.at_end;
  }
  LaneCovariance to_end = LaneCovariance::Identity();
  to_end.topLeftCorner<2, 2>() = motion.slope.block<2, 2>(k, kChannelParameters);
  mean = (to_end * mean).eval();
  mean.head<kDeviation>() += motion.value.tail<2>();
  by_chain = (to_end * by_chain).eval();
  by_chain.topRows<kDeviation>() += motion.slope.block<2, kChannelParameters>(k, 0);
  covariance = (to_end * covariance * to_end.transpose()).eval();
  return learned;
}

ChainPass ChannelWalk::result() const {
  const Information covariance = Cholesky(information_).inverse();
  const ChannelParameters step = covariance * gradient_;
  const Eigen::Index states = kLaneStates * std::ssize(lanes_);
  Eigen::VectorXd mean(states);
  Eigen::Matrix<double, Eigen::Dynamic, kChannelParameters> by_chain(states, kChannelParameters);
  ChainPass pass{.cost = cost_, .joint = {}, .live = {}, .until = until_};
  const Eigen::Index n = kChannelParameters + states;
  Eigen::MatrixXd& joint = pass.joint.covariance = Eigen::MatrixXd::Zero(n, n);
  for (const FollowedLane& lane : lanes_) {
    const Eigen::Index own = kLaneStates * std::ssize(pass.live);
    mean.segment<kLaneStates>(own) = lane.mean + lane.by_chain * step;
    by_chain.middleRows<kLaneStates>(own) = lane.by_chain;
    joint.block<kLaneStates, kLaneStates>(kChannelParameters + own, kChannelParameters + own) = lane.covariance;
    pass.live.push_back(lane.place);
  }
  Eigen::MatrixXd open(n, kChannelParameters);  // of the state, with the parameters
  open << Information::Identity(), by_chain;
  joint += open * covariance * open.transpose();
  joint = ((joint + joint.transpose()) / 2.0).eval();
  pass.joint.mean.resize(n);
  pass.joint.mean << point_ + step, mean;
  return pass;
}

double student_cost(double nis, double log_determinant, Eigen::Index count) {
  return log_determinant + (kTailDegrees + static_cast<double>(count)) * std::log1p(nis / kTailDegrees);
}

double noise_inflation(double nis, Eigen::Index count, const IekfSettings& settings) {
  const double per_degrees = kDegrees * nis / static_cast<double>(count);
  if (!(per_degrees <= settings.gate)) {
    return 0.0;
  }
  return std::max(std::sqrt(per_degrees) / settings.huber, 1.0);
}

}  // namespace slipwise
