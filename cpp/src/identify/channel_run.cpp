// SPDX-License-Identifier: Apache-2.0
// Filters of the axes' states alone, which carry their derivatives by the actuator along.
#include "slipwise/identify/channel_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/filter/heavy_tails.hpp"
#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kDegrees = 3.0;  // of freedom that gate and Huber's bound are made for

using Information = Eigen::Matrix<double, kChannelParameters, kChannelParameters>;
using StateByActuator = Eigen::Matrix<double, kAxisStates, kChannelParameters>;
using AxisCovariance = Eigen::Matrix<double, kAxisStates, kAxisStates>;
constexpr Eigen::Index kDeviation = 2;  // among the axis's states
constexpr std::array kTwist{&BodyTwist::v, &BodyTwist::vy, &BodyTwist::omega};

}  // namespace

/// An axis that has learned the means of a window, and what these tell of the parameters.
struct ChannelFilter::Learned {
  FollowedAxis axis;
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

ChannelFilter::ChannelFilter(std::shared_ptr<const ChannelModel> model, double size, const ChannelParameters& point)
    : model_(std::move(model)), size_(size), point_(point) {
  const Estimate& prior = model_->prior;
  const Eigen::VectorXd away = point - prior.mean;
  cost_ = away.cwiseQuotient(prior.covariance.diagonal().cwiseSqrt()).squaredNorm();
  information_ = Cholesky(prior.covariance).inverse();
  gradient_ = -information_ * away;
}

void ChannelFilter::learn(const ChannelWindow& window) {
  begin(window);
  if (axes_.empty()) {
    return;
  }
  std::vector<AxisMotion> motions;
  std::vector<Learned> learned;
  double nis = 0.0;
  double log_determinant = 0.0;
  for (const FollowedAxis& followed : axes_) {
    const ActuatorAxis axis = axis_of(model_->parts[followed.place], point_);
    motions.push_back(axis_through(window, axis, {.fast = followed.mean[0], .slow = followed.mean[1]}));
    learned.push_back(filter(followed, motions.back(), window.observed, size_));
    nis += learned.back().nis;
    log_determinant += learned.back().log_determinant;
  }
  const Eigen::Index count = std::ssize(axes_) * std::ssize(window.observed.twist);
  cost_ += student_cost(nis, log_determinant, count);
  const double larger = noise_inflation(nis, count, model_->iekf);
  if (!(larger > 0.0)) {
    axes_.clear();
    return;
  }
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const Learned taken = larger > 1.0 ? filter(axes_[i], motions[i], window.observed, larger * size_) : learned[i];
    information_ += taken.information;
    gradient_ += taken.gradient;
    axes_[i] = taken.axis;
  }
}

void ChannelFilter::begin(const ChannelWindow& window) {
  if (!same_stamp(window.observed.edges.front(), until_)) {
    axes_.clear();
  }
  until_ = window.observed.edges.back();
  for (std::size_t i = 0; i < model_->parts.size(); ++i) {
    if (std::ranges::find(axes_, i, &FollowedAxis::place) != axes_.end()) {
      continue;
    }
    if (const auto first = first_state(window, axis_of(model_->parts[i], point_), model_->noise.deviation * size_)) {
      axes_.push_back({i, first->mean, first->variance.asDiagonal(), StateByActuator::Zero()});
    }
  }
}

/// The Kalman filter and its derivative, one mean after the other. Its state are the fast and the slow mode at the
/// window's start, from where they were thought to be, and the deviation now.
ChannelFilter::Learned ChannelFilter::filter(const FollowedAxis& axis, const AxisMotion& motion,
                                             const WheelMeans& observed, double size) const {
  Learned learned{.axis = axis};
  auto& [place, mean, covariance, by_actuator] = learned.axis;
  mean.head<kDeviation>().setZero();
  const auto k = std::ssize(observed.twist);
  for (Eigen::Index i = 0; i < k; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const ActuatorNoiseInterval noise =
        actuator_noise_interval(model_->noise, observed.edges[at + 1] - observed.edges[at], observed.samples[at]);
    const AxisVector h(motion.derivative(i, 5), motion.derivative(i, 6), noise.mean);
    const double innovation = observed.twist[at].*model_->parts[place] - motion.value[i] - h.dot(mean);
    const ChannelParameters moved =
        motion.derivative.row(i).head<kChannelParameters>().transpose() + by_actuator.transpose() * h;
    AxisVector cross = covariance * h;
    const double variance = h.dot(cross) + size * noise.of_mean;
    learned.nis += innovation * innovation / variance;
    learned.log_determinant += std::log(variance);
    learned.information += moved * moved.transpose() / variance;
    learned.gradient += moved * (innovation / variance);
    const AxisVector kept(1.0, 1.0, noise.kept);  // until the interval's end
    cross = kept.cwiseProduct(cross);
    cross[kDeviation] += size * noise.crossed;
    mean = kept.cwiseProduct(mean) + cross * (innovation / variance);
    by_actuator = kept.asDiagonal() * by_actuator - cross / variance * moved.transpose();
    covariance = (kept.asDiagonal() * covariance * kept.asDiagonal() - cross * cross.transpose() / variance).eval();
    covariance(kDeviation, kDeviation) += size * noise.at_end;
  }
  AxisCovariance to_end = AxisCovariance::Identity();
  to_end.topLeftCorner<2, 2>() = motion.derivative.block<2, 2>(k, kChannelParameters);
  mean = (to_end * mean).eval();
  mean.head<kDeviation>() += motion.value.tail<2>();
  by_actuator = (to_end * by_actuator).eval();
  by_actuator.topRows<kDeviation>() += motion.derivative.block<2, kChannelParameters>(k, 0);
  covariance = (to_end * covariance * to_end.transpose()).eval();
  return learned;
}

NormalEquations ChannelFilter::equations() const { return {information_, gradient_}; }

ChannelRun ChannelFilter::result() const {
  const Information covariance = Cholesky(information_).inverse();
  const ChannelParameters step = covariance * gradient_;
  const Eigen::Index states = kAxisStates * std::ssize(axes_);
  Eigen::VectorXd mean(states);
  Eigen::Matrix<double, Eigen::Dynamic, kChannelParameters> by_actuator(states, kChannelParameters);
  ChannelRun pass{.cost = cost_, .joint = {}, .live = {}, .until = until_};
  const Eigen::Index n = kChannelParameters + states;
  Eigen::MatrixXd& joint = pass.joint.covariance = Eigen::MatrixXd::Zero(n, n);
  for (const FollowedAxis& axis : axes_) {
    const Eigen::Index own = kAxisStates * std::ssize(pass.live);
    mean.segment<kAxisStates>(own) = axis.mean + axis.by_actuator * step;
    by_actuator.middleRows<kAxisStates>(own) = axis.by_actuator;
    joint.block<kAxisStates, kAxisStates>(kChannelParameters + own, kChannelParameters + own) = axis.covariance;
    pass.live.push_back(axis.place);
  }
  Eigen::MatrixXd open(n, kChannelParameters);  // of the state, with the parameters
  open << Information::Identity(), by_actuator;
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
