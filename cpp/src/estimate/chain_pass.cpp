// SPDX-License-Identifier: Apache-2.0
// Filters of the lanes' states alone, which carry their derivatives by the chain along.
#include "slipwise/estimate/chain_pass.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "slipwise/estimate/heavy_tails.hpp"
#include "slipwise/linear/cholesky.hpp"

namespace slipwise {
namespace {

constexpr double kDegrees = 3.0;  // of freedom that gate and Huber's bound are made for

using Information = Eigen::Matrix<double, kChannelParameters, kChannelParameters>;
using StateByChain = Eigen::Matrix<double, kLaneStates, kChannelParameters>;
using LaneCovariance = Eigen::Matrix<double, kLaneStates, kLaneStates>;
using StateColumns = Eigen::Matrix<double, Eigen::Dynamic, kLaneStates>;

}  // namespace

/// A window of a lane before it is learned.
struct ChannelWalk::Observed {
  LanePassage at;
  Eigen::VectorXd innovation;          ///< [K]
  StateColumns spread;                 ///< [K, 3] H P
  Eigen::LLT<Eigen::MatrixXd> factor;  ///< of S = H P H^T + R

  auto by_state() const { return at.by_state.topRows(innovation.size()); }
  double nis() const { return factor.matrixL().solve(innovation).squaredNorm(); }
  double log_determinant() const { return 2.0 * factor.matrixLLT().diagonal().array().log().sum(); }
  void expect(double size, const DriveNoiseMeans& noise) {
    const Eigen::Index k = innovation.size();
    factor.compute(spread.lazyProduct(by_state().transpose()) + size * noise.covariance.topLeftCorner(k, k));
  }
};

ChannelWalk::ChannelWalk(const ChannelModel& model, double size, const ChannelParameters& point)
    : model_(&model), size_(size), point_(point) {
  const Eigen::VectorXd away = point - model.prior.mean;
  cost_ = away.cwiseQuotient(model.prior.covariance.diagonal().cwiseSqrt()).squaredNorm();
  information_ = Cholesky(model.prior.covariance).inverse();
  gradient_ = -information_ * away;
}

void ChannelWalk::learn(const ChannelWindow& window, const DriveNoiseMeans& noise) {
  begin(window);
  if (lanes_.empty()) {
    return;
  }
  std::vector<Observed> seen;
  double nis = 0.0;
  double log_determinant = 0.0;
  Eigen::Index count = 0;
  for (const FollowedLane& lane : lanes_) {
    seen.push_back(observe(lane, window, noise));
    nis += seen.back().nis();
    log_determinant += seen.back().log_determinant();
    count += seen.back().innovation.size();
  }
  cost_ += student_cost(nis, log_determinant, count);
  const double larger = noise_inflation(nis, count, model_->iekf);
  if (!(larger > 0.0)) {
    lanes_.clear();
    return;
  }
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    if (larger > 1.0) {
      seen[i].expect(larger * size_, noise);
    }
    update(lanes_[i], seen[i], larger * size_, noise);
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

ChannelWalk::Observed ChannelWalk::observe(const FollowedLane& followed, const ChannelWindow& window,
                                           const DriveNoiseMeans& noise) const {
  const ActuatorAxis lane = lane_of(model_->parts[followed.place], point_);
  Observed seen{lane_passage(window, lane, followed.mean, noise), lane_means(window.seen, lane), {}, {}};
  seen.innovation -= seen.at.value.head(seen.innovation.size());
  seen.spread = seen.by_state() * followed.covariance;
  seen.expect(size_, noise);
  return seen;
}

/// The Kalman filter of the state, and its derivative; all that S^-1 weighs is whitened by the factor of S.
void ChannelWalk::update(FollowedLane& lane, const Observed& seen, double size, const DriveNoiseMeans& noise) {
  const Eigen::Index k = seen.innovation.size();
  const auto end_by_state = seen.at.by_state.bottomRows<kLaneStates>();
  const auto whiten = seen.factor.matrixL();
  StateColumns cross = seen.spread * end_by_state.transpose();
  cross.col(2) += size * noise.covariance.col(k).head(k);
  whiten.solveInPlace(cross);
  const Eigen::VectorXd innovation = whiten.solve(seen.innovation);
  Eigen::Matrix<double, Eigen::Dynamic, kChannelParameters> by_chain =
      seen.at.by_chain.topRows(k) + seen.by_state() * lane.by_chain;
  whiten.solveInPlace(by_chain);
  information_ += by_chain.transpose() * by_chain;
  gradient_ += by_chain.transpose() * innovation;
  lane.mean = seen.at.value.tail<kLaneStates>() + cross.transpose() * innovation;
  lane.by_chain =
      (seen.at.by_chain.bottomRows<kLaneStates>() + end_by_state * lane.by_chain - cross.transpose() * by_chain).eval();
  lane.covariance = (end_by_state * lane.covariance * end_by_state.transpose() - cross.transpose() * cross).eval();
  lane.covariance(2, 2) += size * noise.covariance(k, k);
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
