// SPDX-License-Identifier: Apache-2.0
// Augmented filter over parameters, present pose and cloned pose.
#include "slipwise/thesis/delayed_state.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "slipwise/filter/linear_update.hpp"
#include "slipwise/filter/prior.hpp"
#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kSettled = 1e-2;  // in standard deviations: a new linearisation that moves less is not needed

/// blkdiag(R, 1).
Eigen::Matrix3d turned(double theta) {
  Eigen::Matrix3d gamma = Eigen::Matrix3d::Identity();
  gamma.topLeftCorner<2, 2>() = rotation(theta);
  return gamma;
}

DelayedState::Leg leg_of(const Segment& segment) {
  return {.end = segment.end, .initial = segment.initial, .gx = segment.gx, .gy = segment.gy};
}

}  // namespace

DelayedState::DelayedState(MotionModel model, const Estimate& prior, const EstimatorSettings& settings)
    : model_(std::move(model)),
      noise_(settings.noise),
      iekf_(settings.iekf),
      iterations_(settings.delayed_state.iterations),
      joint_{Eigen::VectorXd::Zero(prior.mean.size() + 6),
             Eigen::MatrixXd::Zero(prior.mean.size() + 6, prior.mean.size() + 6)} {
  joint_.mean.head(prior.mean.size()) = prior.mean;
  joint_.covariance.topLeftCorner(prior.mean.size(), prior.mean.size()) = prior.covariance;
}

Estimate DelayedState::estimate() const {
  const Eigen::Index m = model_.size();
  return {joint_.mean.head(m), joint_.covariance.topLeftCorner(m, m)};
}

Eigen::Matrix3d DelayedState::pose_noise() const {
  const double xy = noise_.pose_std_xy * noise_.pose_std_xy * (scale_.x() + scale_.y()) / 2.0;
  const double yaw = noise_.pose_std_yaw * noise_.pose_std_yaw * scale_.z();
  return Eigen::Vector3d(xy, xy, yaw).asDiagonal();
}

void DelayedState::start(double time, const Pose2& measured) {
  const Eigen::Index m = model_.size();
  joint_.mean.segment<3>(m) = measured.vector();
  joint_.covariance.bottomRows(6).setZero();
  joint_.covariance.rightCols(6).setZero();
  joint_.covariance.block<3, 3>(m, m) = pose_noise();
  time_ = time;
  measured_ = measured;
  started_ = true;
  clone();
}

void DelayedState::clone() {
  const Eigen::Index m = model_.size();
  joint_.mean.tail<3>() = joint_.mean.segment<3>(m);
  joint_.covariance.bottomRows<3>() = joint_.covariance.middleRows<3>(m).eval();
  joint_.covariance.rightCols<3>() = joint_.covariance.middleCols<3>(m).eval();
}

void DelayedState::advance(const InputHistory& inputs, const Leg& leg) {
  advance_at({joint_.mean.head(model_.size()), pose()}, inputs, leg, 1.0);
}

/// X_now <- X_now exp-path(p) with the first-order expansion about `point`: F = [blkdiag(R, 1) J, Phi] of
/// derivations/thesis.md.
void DelayedState::advance_at(const Point& point, const InputHistory& inputs, const Leg& leg, double inflation) {
  if (!started_ || !(leg.end > time_)) {
    throw std::invalid_argument("a delayed-state filter must be started, and advances to later times only");
  }
  const Segment segment{.start = time_, .end = leg.end, .initial = leg.initial, .gx = leg.gx, .gy = leg.gy};
  const auto at = linearize_segment(model_, point.parameters, inputs, segment);
  const Eigen::Index m = model_.size();
  const Pose2 end = compose(point.pose, at.pose());
  const Eigen::Matrix3d gamma = turned(point.pose.theta);
  const Eigen::Matrix3d scaled_gamma = gamma * scale_.cwiseSqrt().asDiagonal();
  Eigen::Matrix<double, 3, Eigen::Dynamic> f(3, m + 3);
  f << gamma * at.by_parameter, transition(point.pose, end);
  Eigen::VectorXd away(m + 3);
  away << joint_.mean.head(m) - point.parameters, joint_.mean.segment<3>(m) - point.pose.vector();
  joint_.mean.segment<3>(m) = end.vector() + f * away;
  const Eigen::Matrix<double, 3, Eigen::Dynamic> cross = f * joint_.covariance.topRows(m + 3);
  const Eigen::Matrix3d own = cross.leftCols(m + 3) * f.transpose() +
                              scaled_gamma * slip_covariance(at.path, noise_) * scaled_gamma.transpose() * inflation;
  joint_.covariance.middleRows<3>(m) = cross;
  joint_.covariance.middleCols<3>(m) = cross.transpose();
  joint_.covariance.block<3, 3>(m, m) = (own + own.transpose()) / 2.0;
  time_ = leg.end;
}

/// By a direct measurement of the pose that stands at `row`.
void DelayedState::update(Eigen::Index row, const Pose2& measured, const Eigen::Matrix3d& noise) {
  const Eigen::Vector3d innovation = measured.vector() - joint_.mean.segment<3>(row);
  Eigen::Matrix3Xd by_state = Eigen::Matrix3Xd::Zero(3, joint_.mean.size());
  by_state.middleCols<3>(row).setIdentity();
  joint_.mean += linear_update(joint_.covariance, by_state, noise) * innovation;
}

void DelayedState::correct_delayed(const Pose2& measured) { update(model_.size() + 3, measured, pose_noise()); }

void DelayedState::correct(const Pose2& measured) {
  update(model_.size(), measured, pose_noise());
  measured_ = measured;
}

/// The innovation of X_now, how large it is, and what it counts.
IekfUpdate DelayedState::judge(const Pose2& end) const {
  const Eigen::Index m = model_.size();
  IekfUpdate update{.estimate = estimate(),
                    .innovation = end.vector() - joint_.mean.segment<3>(m),
                    .innovation_covariance = joint_.covariance.block<3, 3>(m, m) + pose_noise(),
                    .nis = 0.0,
                    .weight = 1.0,
                    .status = Status::Converged};
  update.nis = normalised_square(update.innovation, update.innovation_covariance);
  update.weigh(iekf_);
  return update;
}

/// Parameters near the optimum: an IEKF of this segment alone, with its step-halving.
Eigen::VectorXd DelayedState::settled(const InputHistory& inputs, const Segment& segment, const Pose2& end) const {
  Segment observed = segment;
  observed.measured.front().z = between(pose(), end).vector();
  const Estimate before = estimate();
  auto at = linearize_segment(model_, before.mean, inputs, observed);
  const RowsCovariance noise = segment_noise(at.path, rows_of(observed.measured), noise_, scale_);
  IekfSettings settings = iekf_;
  settings.gate = std::numeric_limits<double>::infinity();
  return iekf_update(model_, before, inputs, observed, std::move(at), noise, settings).estimate.mean;
}

void DelayedState::learn_weighted(const InputHistory& inputs, const Segment& segment, const Pose2& end, double weight) {
  const Eigen::Index m = model_.size();
  const Estimate before = joint_;
  Point point{settled(inputs, segment, end), pose()};
  for (int i = 0; i < iterations_; ++i) {
    joint_ = before;
    time_ = segment.start;
    advance_at(point, inputs, leg_of(segment), 1.0 / weight);
    update(m, end, pose_noise() / weight);
    const Eigen::VectorXd step = joint_.mean.head(m) - point.parameters;
    const Eigen::VectorXd sigmas = joint_.covariance.diagonal().head(m).cwiseSqrt();
    point = {joint_.mean.head(m), at_row(m + 3)};
    if ((step.cwiseAbs() - kSettled * sigmas).maxCoeff() <= 0.0) {
      break;
    }
  }
}

IekfUpdate DelayedState::learn(const InputHistory& inputs, const Segment& segment) {
  if (!started_ || !same_stamp(segment.start, time_)) {
    start(segment.start, {});
  }
  time_ = segment.start;
  const Pose2 end = compose(measured_, motion_of(segment.measured));
  clone();
  const Estimate before = joint_;
  advance(inputs, leg_of(segment));
  IekfUpdate result = judge(end);
  joint_ = before;
  if (result.status == Status::Rejected) {
    start(segment.end, end);
    return result;
  }
  learn_weighted(inputs, segment, end, result.weight);
  measured_ = end;
  result.estimate = estimate();
  return result;
}

/// Information added to single parameters, negative where the prior widens (derivations/filter.md); the clone
/// makes the covariance singular, so that it is never inverted.
bool DelayedState::change_prior(const Eigen::VectorXd& old_std, const Eigen::VectorXd& new_std) {
  Estimate changed = joint_;
  for (Eigen::Index i = 0; i < new_std.size(); ++i) {
    const double added = 1.0 / (new_std[i] * new_std[i]) - 1.0 / (old_std[i] * old_std[i]);
    if (added != 0.0) {
      const Eigen::VectorXd column = changed.covariance.col(i);
      const Eigen::VectorXd gain = column / (1.0 / added + column[i]);
      changed.mean -= gain * changed.mean[i];
      changed.covariance -= gain * column.transpose();
    }
  }
  const Eigen::Index m = model_.size();
  const Eigen::VectorXd per_unit = changed.covariance.diagonal().head(m).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation =
      per_unit.asDiagonal() * changed.covariance.topLeftCorner(m, m) * per_unit.asDiagonal();
  if (!changed.covariance.allFinite() || !correlation.allFinite() || !Cholesky(correlation).positive_definite()) {
    return false;
  }
  joint_ = std::move(changed);
  return true;
}

}  // namespace slipwise
