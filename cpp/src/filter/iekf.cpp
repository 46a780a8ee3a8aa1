// SPDX-License-Identifier: Apache-2.0
// The IEKF update: Gauss-Newton on the MAP cost of one segment, covariance once at the end in Joseph form.
#include "slipwise/filter/iekf.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/filter/linear_update.hpp"
#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/linear/symmetric_eigen.hpp"
#include "slipwise/linear/tuning.hpp"
#include "slipwise/segment/carried_linearization.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kUnknown, 1.0);    // [ln s]; a time is known at least to a factor of e before any data
SLIPWISE_TUNING(kStraight, 0.03);  // [ln s], [s] or [-]; over so little of the actuator a segment is linear

/// What sensors measured of a segment as a measurement of the parameters.
struct MeasuredSegment {
  using At = SegmentLinearization;
  using Innovation = Rows;

  const MotionModel& model;
  const InputHistory& inputs;
  const Segment& segment;
  const RowsCovariance& covariance;

  At near(const Eigen::VectorXd& parameters, const Eigen::VectorXd& step, const At& before) const {
    auto straight = carried(before, model, step, covariance);
    return straight ? std::move(*straight) : linearize_segment(model, parameters, inputs, segment);
  }
  Innovation innovation(const At& at) const { return error_of(segment, at); }
  static const RowsJacobian& jacobian(const At& at) { return at.by_parameter; }
  const RowsCovariance& noise(const At& /*at*/) const { return covariance; }
};

/// How far what is measured bends away from its linearisation over the open part of the actuator: the covariance
/// of the second-order term along the actuator's principal directions (derivations/filter.md). The slip is
/// linear enough.
RowsCovariance second_order(const MotionModel& model, const Estimate& estimate, const InputHistory& inputs,
                            const Segment& segment, const Rows& predicted) {
  RowsCovariance spread = RowsCovariance::Zero(predicted.size(), predicted.size());
  const auto rows = Eigen::seqN(model.slip_size(), model.actuator_size());
  const SymmetricEigen open = symmetric_eigen(estimate.covariance(rows, rows));
  for (Eigen::Index i = 0; i < model.actuator_size(); ++i) {
    const double std = std::sqrt(std::max(open.values[i], 0.0));
    if (std < kStraight) {
      continue;
    }
    const Eigen::VectorXd step = estimate.covariance(Eigen::all, rows) * open.vectors.col(i) / std;
    const auto at = [&](double sign) {
      return integrate_segment(model, estimate.mean + sign * step, inputs, segment).rows();
    };
    const Rows second = (at(1.0) + at(-1.0)) / 2.0 - predicted;
    spread += 2.0 * second * second.transpose();
  }
  return spread;
}

void check(const MotionModel& model, const Estimate& prior, const Segment& segment, const RowsCovariance& noise) {
  model.check(prior.mean);
  if (prior.covariance.rows() != model.size() || prior.covariance.cols() != model.size()) {
    throw std::invalid_argument("the prior's covariance must be square with one row per parameter, " +
                                std::to_string(model.size()) + "; got " + std::to_string(prior.covariance.rows()) +
                                " x " + std::to_string(prior.covariance.cols()));
  }
  if (!(segment.end > segment.start) || !rows_of(segment.measured).allFinite()) {
    throw std::invalid_argument("a segment must end after it starts and have finite measurements");
  }
  if (noise.rows() != rows_of(segment.measured).size() || !noise.allFinite() || !Cholesky(noise).positive_definite()) {
    throw std::invalid_argument("a segment's noise covariance must be finite and positive definite");
  }
}

}  // namespace

// NOLINTNEXTLINE(readability-function-size): knowledge (model, prior), observations, and the settings.
IekfUpdate iekf_update(const MotionModel& model, const Estimate& prior, const InputHistory& inputs,
                       const Segment& segment, const RowsCovariance& noise, const IekfSettings& settings) {
  check(model, prior, segment, noise);
  return iekf_update(model, prior, inputs, segment, linearize_segment(model, prior.mean, inputs, segment), noise,
                     settings);
}

// NOLINTNEXTLINE(readability-function-size): the same, and what is at hand already.
IekfUpdate iekf_update(const MotionModel& model, const Estimate& prior, const InputHistory& inputs,
                       const Segment& segment, SegmentLinearization at_prior, const RowsCovariance& noise,
                       const IekfSettings& settings) {
  check(model, prior, segment, noise);
  IekfUpdate update{.estimate = prior,
                    .innovation = error_of(segment, at_prior),
                    .innovation_covariance = innovation_covariance(prior.covariance, at_prior.by_parameter, noise),
                    .nis = 0.0,
                    .weight = 1.0,
                    .status = Status::Converged};
  update.nis = normalised_square(update.innovation, update.innovation_covariance);
  update.weigh(settings);
  if (update.weight == 0.0) {
    update.at = std::move(at_prior);
    return update;
  }
  const RowsCovariance weighted_noise = noise / update.weight;
  const MeasuredSegment measured{model, inputs, segment, weighted_noise};
  const MapUpdate problem(prior, measured);
  auto now = problem.begin(std::move(at_prior));
  if (!problem.minimize(now, settings.map())) {  // nothing was learned: the prior stands
    update.weight = 0.0;
    update.status = Status::NotConverged;
    update.at = std::move(now.at);  // at the prior still
    return update;
  }
  update.estimate.mean = now.state;
  linear_update(update.estimate.covariance, now.at.by_parameter, weighted_noise);
  if (model.actuator_size() > 0) {
    update.bent = second_order(model, update.estimate, inputs, segment, now.at.predicted);
    if (!update.bent.isZero(0.0)) {
      update.estimate.covariance = prior.covariance;
      linear_update(update.estimate.covariance, now.at.by_parameter, weighted_noise + update.bent);
    }
  }
  follow_times(model, prior.mean, update.estimate);
  update.at = std::move(now.at);
  return update;
}

double IekfSettings::weight(double nis) const {
  const double sigmas = std::sqrt(nis);
  return !(nis <= gate) ? 0.0 : sigmas > huber ? huber / sigmas : 1.0;
}

void IekfUpdate::weigh(const IekfSettings& settings) {
  weight = settings.weight(nis);
  status = weight == 0.0 ? Status::Rejected : weight < 1.0 ? Status::Downweighted : Status::Converged;
}

void follow_times(const MotionModel& model, const Eigen::VectorXd& before, Estimate& estimate) {
  const Eigen::ArrayXd most = (kUnknown / estimate.covariance.diagonal().array().sqrt()).max(1.0);
  const Eigen::VectorXd reparametrised =
      (model.log_time_derivatives(before).array() / model.log_time_derivatives(estimate.mean).array()).min(most);
  estimate.covariance = (reparametrised.asDiagonal() * estimate.covariance * reparametrised.asDiagonal()).eval();
}

}  // namespace slipwise
