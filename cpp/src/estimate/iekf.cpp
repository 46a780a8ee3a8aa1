// SPDX-License-Identifier: Apache-2.0
// The IEKF update: Gauss-Newton on the MAP cost of one segment, covariance once at the end in Joseph form.
#include "slipwise/estimate/iekf.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/linear/symmetric_eigen.hpp"
#include "slipwise/linear/tuning.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

using Jacobian = Eigen::Matrix<double, 3, Eigen::Dynamic>;

SLIPWISE_TUNING(kUnknown, 1.0);           // [ln s]; a time is known at least to a factor of e before any data
SLIPWISE_TUNING(kStraight, 0.03);         // [ln s], [s] or [-]; over so little of the chain a segment is linear
constexpr double kNegligibleCost = 1e-9;  // in squared sigmas: the rounding of a perfect fit is no uphill step

/// S = J P J^T + R.
Eigen::Matrix3d innovation_covariance(const Eigen::MatrixXd& prior, const Jacobian& jacobian,
                                      const Eigen::Matrix3d& noise) {
  const Jacobian spread = jacobian * prior;
  return spread.lazyProduct(jacobian.transpose()) + noise;
}

/// A point of the iteration. The mean is kept as prior + P dual, so that the prior's cost needs no inverse of P.
struct Iterate {
  Eigen::VectorXd dual;
  Eigen::VectorXd mean;
  SegmentLinearization at;
  Eigen::Vector3d innovation;
  double cost;
};

class MapProblem {
 public:
  MapProblem(const MotionModel& model, const Estimate& prior, const InputTrack& inputs, const Segment& segment,
             const Eigen::Matrix3d& noise)
      : model_(model), prior_(prior), inputs_(inputs), segment_(segment), noise_(noise) {}

  /// The prior's mean, where the segment is linearised `at`.
  Iterate begin(SegmentLinearization at) const {
    const Eigen::Vector3d r = segment_.measured.vector() - at.predicted.vector();
    return {Eigen::VectorXd::Zero(prior_.mean.size()), prior_.mean, std::move(at), r, normalised_square(r, noise_)};
  }

  Iterate evaluate(Eigen::VectorXd dual) const {
    const Eigen::VectorXd away = prior_.covariance * dual;
    Eigen::VectorXd mean = prior_.mean + away;
    SegmentLinearization at = linearize_segment(model_, mean, inputs_, segment_);
    const Eigen::Vector3d r = segment_.measured.vector() - at.predicted.vector();
    const double cost = dual.dot(away) + normalised_square(r, noise_);
    return {std::move(dual), std::move(mean), std::move(at), r, cost};
  }

  /// p_{i+1} = p- + K_i [z - h(p_i) - J_i (p- - p_i)], as a dual vector.
  Eigen::VectorXd gauss_newton_dual(const Iterate& i) const {
    const auto& jacobian = i.at.by_parameter;
    const Eigen::Matrix3d s = innovation_covariance(prior_.covariance, jacobian, noise_);
    return jacobian.transpose() * solve_innovation(s, i.innovation - jacobian * (prior_.mean - i.mean));
  }

  /// What a step in dual coordinates lowers the cost by, were the segment linear.
  double promised(const Iterate& i, const Eigen::VectorXd& step) const {
    const Eigen::VectorXd moved = prior_.covariance * step;
    const Eigen::Vector3d seen = i.at.by_parameter * moved;
    return step.dot(moved) + normalised_square(seen, noise_);
  }

  /// Goes a step, or half of it and so on while the MAP cost grows. False when nothing helps.
  bool descend(Iterate& i, const Eigen::VectorXd& full, int halvings) const {
    for (double share = 1.0; halvings >= 0; --halvings, share /= 2.0) {
      Iterate next = evaluate(i.dual + share * full);
      if (std::isfinite(next.cost) && next.cost <= i.cost * (1.0 + 1e-12) + kNegligibleCost) {
        i = std::move(next);
        return true;
      }
    }
    return false;
  }

  /// Gauss-Newton steps until they gain little. False when not even the first one helps.
  bool minimize(Iterate& i, const IekfSettings& settings) const {
    for (int steps = 0; steps < settings.iterations; ++steps) {
      const Eigen::VectorXd full = gauss_newton_dual(i) - i.dual;
      if (steps > 0 && promised(i, full) < settings.tolerance) {
        break;
      }
      const double cost_before = i.cost;
      if (!descend(i, full, settings.halvings)) {
        return steps > 0;
      }
      if (cost_before - i.cost < settings.tolerance) {
        break;
      }
    }
    return true;
  }

 private:
  const MotionModel& model_;
  const Estimate& prior_;
  const InputTrack& inputs_;
  const Segment& segment_;
  const Eigen::Matrix3d& noise_;
};

/// (I - K J) P (I - K J)^T + K R K^T.
Eigen::MatrixXd joseph_form(const Eigen::MatrixXd& prior, const Jacobian& jacobian, const Eigen::Matrix3d& noise) {
  if (prior.size() == 0) {
    return prior;  // the plain model has nothing to learn
  }
  const Jacobian spread = jacobian * prior;
  const Eigen::Matrix3d s = spread.lazyProduct(jacobian.transpose()) + noise;
  const Eigen::MatrixX3d gain = kalman_gain(s, spread);
  const Eigen::MatrixXd keep = Eigen::MatrixXd::Identity(prior.rows(), prior.cols()) - gain * jacobian;
  const Eigen::MatrixXd posterior = keep * prior * keep.transpose() + gain * noise * gain.transpose();
  return (posterior + posterior.transpose()) / 2.0;
}

/// How far the segment's chart bends away from its linearisation over what is left open of the chain: the covariance of
/// the second-order term along the chain's principal directions (derivations.md, section 6). The slip is linear enough.
Eigen::Matrix3d bending(const MotionModel& model, const Estimate& estimate, const InputTrack& inputs,
                        const Segment& segment, const Eigen::Vector3d& predicted) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  const auto rows = Eigen::seqN(model.slip_size(), model.chain_size());
  const SymmetricEigen open = symmetric_eigen(estimate.covariance(rows, rows));
  for (Eigen::Index i = 0; i < model.chain_size(); ++i) {
    const double std = std::sqrt(std::max(open.values[i], 0.0));
    if (std < kStraight) {
      continue;
    }
    const Eigen::VectorXd step = estimate.covariance(Eigen::all, rows) * open.vectors.col(i) / std;
    const auto at = [&](double sign) {
      return integrate_segment(model, estimate.mean + sign * step, inputs, segment).sensor_motion().vector();
    };
    const Eigen::Vector3d second = (at(1.0) + at(-1.0)) / 2.0 - predicted;
    spread += 2.0 * second * second.transpose();
  }
  return spread;
}

void check(const MotionModel& model, const Estimate& prior, const Segment& segment, const Eigen::Matrix3d& noise) {
  model.check(prior.mean);
  if (prior.covariance.rows() != model.size() || prior.covariance.cols() != model.size()) {
    throw std::invalid_argument("the prior's covariance must be square with one row per parameter, " +
                                std::to_string(model.size()) + "; got " + std::to_string(prior.covariance.rows()) +
                                " x " + std::to_string(prior.covariance.cols()));
  }
  if (!(segment.end > segment.start) || !segment.measured.vector().allFinite()) {
    throw std::invalid_argument("a segment must end after it starts and have finite measurements");
  }
  if (!noise.allFinite() || !Cholesky(noise).positive_definite()) {
    throw std::invalid_argument("a segment's noise covariance must be finite and positive definite");
  }
}

}  // namespace

// NOLINTNEXTLINE(readability-function-size): what is known (model, prior), what was seen, and settings with defaults.
IekfUpdate iekf_update(const MotionModel& model, const Estimate& prior, const InputTrack& inputs,
                       const Segment& segment, const Eigen::Matrix3d& noise, const IekfSettings& settings) {
  check(model, prior, segment, noise);
  return iekf_update(model, prior, inputs, segment, linearize_segment(model, prior.mean, inputs, segment), noise,
                     settings);
}

// NOLINTNEXTLINE(readability-function-size): the same, and what is at hand already.
IekfUpdate iekf_update(const MotionModel& model, const Estimate& prior, const InputTrack& inputs,
                       const Segment& segment, SegmentLinearization at_prior, const Eigen::Matrix3d& noise,
                       const IekfSettings& settings) {
  check(model, prior, segment, noise);
  Iterate now = MapProblem(model, prior, inputs, segment, noise).begin(std::move(at_prior));
  IekfUpdate update{.estimate = prior,
                    .innovation = now.innovation,
                    .innovation_covariance = innovation_covariance(prior.covariance, now.at.by_parameter, noise),
                    .nis = 0.0,
                    .weight = 1.0,
                    .status = Status::Converged,
                    .at = now.at};
  update.nis = normalised_square(update.innovation, update.innovation_covariance);
  if (!(update.nis <= settings.gate)) {
    update.weight = 0.0;
    update.status = Status::Rejected;
    return update;
  }
  if (const double sigmas = std::sqrt(update.nis); sigmas > settings.huber) {
    update.weight = settings.huber / sigmas;
    update.status = Status::Downweighted;
  }
  const Eigen::Matrix3d weighted_noise = noise / update.weight;
  const MapProblem problem(model, prior, inputs, segment, weighted_noise);
  now = problem.begin(std::move(now.at));
  if (!problem.minimize(now, settings)) {  // nothing was learned: the prior stands
    update.weight = 0.0;
    update.status = Status::NotConverged;
    return update;
  }
  update.estimate.mean = now.mean;
  update.estimate.covariance = joseph_form(prior.covariance, now.at.by_parameter, weighted_noise);
  if (model.chain_size() > 0) {
    const Eigen::Matrix3d bent = bending(model, update.estimate, inputs, segment, now.at.predicted.vector());
    update.estimate.covariance = joseph_form(prior.covariance, now.at.by_parameter, weighted_noise + bent);
  }
  const Eigen::ArrayXd most = (kUnknown / update.estimate.covariance.diagonal().array().sqrt()).max(1.0);
  const Eigen::VectorXd carry = (model.even_slopes(prior.mean).array() / model.even_slopes(now.mean).array()).min(most);
  update.estimate.covariance = (carry.asDiagonal() * update.estimate.covariance * carry.asDiagonal()).eval();
  update.at = std::move(now.at);
  return update;
}

}  // namespace slipwise
