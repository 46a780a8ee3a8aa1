// SPDX-License-Identifier: Apache-2.0
// Two posteriors joined into one.
#include "slipwise/hypotheses/cascaded_model.hpp"

#include <numeric>
#include <tuple>
#include <utility>

#include "slipwise/actuator/kinematics.hpp"
#include "slipwise/filter/base_link_model.hpp"

namespace slipwise {
namespace {

MotionModel joined_model(const MotionModel& slip, double wheelbase) {
  return {slip.basis(),
          {.dynamics = true,
           .clock_offset = slip.learned().clock_offset,
           .response = true,
           .sensor_extrinsics = slip.learned().sensor_extrinsics,
           .wheelbase = wheelbase}};
}

std::vector<Eigen::Index> range(Eigen::Index first, Eigen::Index last) {
  std::vector<Eigen::Index> places(static_cast<std::size_t>(last - first));
  std::iota(places.begin(), places.end(), first);
  return places;
}

/// Places of what was learned behind the wheels, but for lags of the body.
std::vector<Eigen::Index> places_without_lags(const MotionModel& slip) {
  std::vector<Eigen::Index> places = range(0, slip.slip_size());
  const std::vector<Eigen::Index> others = range(slip.slip_size() + (slip.learned().lags ? 2 : 0), slip.size());
  places.insert(places.end(), others.begin(), others.end());
  return places;
}

/// The same estimate: behind an actuator that lags itself, lags of the body count as lateness of the poses.
Estimate without_lags(const MotionModel& slip, const Estimate& estimate, const std::vector<Eigen::Index>& kept) {
  Eigen::VectorXd mean = estimate.mean(kept);
  Eigen::MatrixXd by = Eigen::MatrixXd::Identity(slip.size(), slip.size())(kept, Eigen::all);
  if (slip.learned().lags) {  // the clock offset comes behind them
    const Eigen::Index clock = slip.slip_size();
    by.row(clock).segment<2>(clock) = lateness_of_lags(slip, estimate.mean);
    mean[clock] += by.row(clock).segment<2>(clock).sum();
  }
  return {std::move(mean), by * estimate.covariance * by.transpose()};
}

bool stronger(const SlipChange& a, const SlipChange& b) {
  return std::tuple(a.alarm, a.log_odds) > std::tuple(b.alarm, b.log_odds);
}

}  // namespace

CascadedModel::CascadedModel() : CascadedModel(RememberingAverage(), {}) {}

CascadedModel::CascadedModel(RememberingAverage slip, const CausalFilterSettings& settings, double wheelbase)
    : model_(joined_model(slip.average().model(), wheelbase)),
      noise_(settings.noise.shape),
      slip_(std::move(slip)),
      actuator_(settings),
      score_(settings.noise) {
  const Eigen::Index slips = model_.slip_size();
  const Eigen::Index behind =
      slips + actuator_.model().size();  // clock offset and sensor extrinsics are learned with the slip
  places_of_slip_ = range(0, slips);
  const std::vector<Eigen::Index> others = range(behind, model_.size());
  places_of_slip_.insert(places_of_slip_.end(), others.begin(), others.end());
  places_of_actuator_ = range(slips, behind);
  restart();
  refresh();
}

void CascadedModel::restart() {
  known_slip_ = EstimateHistory(slip_.average().state().estimate);
  known_actuator_ = EstimateHistory(actuator_.estimate());
}

void CascadedModel::start_slip(const DrivenSegment& segment) {
  slip_.start(segment.inputs, segment.segment);
  slip_until_ = segment.segment.end;
}

bool CascadedModel::advance_slip() {
  if (slip_.advance()) {
    return true;
  }
  known_slip_.keep(slip_until_, slip_.average().state().estimate);
  refitted_since_ = refitted_since_ || slip_.average().refitted();
  if (stronger(slip_.average().change(), change_since_)) {
    change_since_ = slip_.average().change();
  }
  return false;
}

void CascadedModel::learn_actuator(const WheelSegment& segment) {
  if (const double wheelbase = model_.learned().wheelbase; wheelbase > 0.0) {
    actuator_.learn(channel_inputs(segment.commands, wheelbase), measured_channels(segment.wheels, wheelbase),
                    segment.start, segment.end);
  } else {
    actuator_.learn(segment.commands, segment.wheels, segment.start, segment.end);
  }
  known_actuator_.keep(segment.known_at, actuator_.estimate());
}

void CascadedModel::begin_with(const Estimate& actuator, const CausalFilterSettings& settings) {
  actuator_.begin_with(actuator, settings);
  restart();
  refresh();
}

Estimate CascadedModel::joined(const Estimate& slip, const Estimate& actuator) const {
  Estimate all{Eigen::VectorXd(model_.size()), Eigen::MatrixXd::Zero(model_.size(), model_.size())};
  const MotionModel& behind = slip_.average().model();
  const Estimate late = without_lags(behind, slip, places_without_lags(behind));
  all.mean(places_of_slip_) = late.mean;
  all.covariance(places_of_slip_, places_of_slip_) = late.covariance;
  all.mean(places_of_actuator_) = actuator.mean;
  all.covariance(places_of_actuator_, places_of_actuator_) = actuator.covariance;
  return all;
}

ScoredSegment CascadedModel::predict(const DrivenSegment& segment) {
  const double start = segment.segment.start;
  const Estimate known = joined(known_slip_.before(start), known_actuator_.before(start));
  return score_.score(model_, known, segment.inputs, segment.segment);
}

void CascadedModel::refresh() {
  const AverageState slip = slip_.average().state();
  const Estimate actuator = actuator_.estimate();
  const Eigen::Index size = model_.size();
  MotionPosterior all{.model = model_,
                      .estimate = joined(slip.estimate, actuator),
                      .prior_std = Eigen::VectorXd(size),
                      .noise = noise_,
                      .noise_scale = score_.noise_scale(),
                      .variance_ratio = Eigen::VectorXd(size),
                      .basis_weights = slip.weights,
                      .structure = Structure::Cascaded};
  const std::vector<Eigen::Index> kept = places_without_lags(slip_.average().model());
  all.prior_std(places_of_slip_) = slip.prior_std(kept);
  all.prior_std(places_of_actuator_) = actuator_.prior_std();
  all.variance_ratio(places_of_slip_) = slip.variance_ratio(kept);
  all.variance_ratio(places_of_actuator_) =
      actuator.covariance.diagonal().cwiseQuotient(actuator_.prior_std().cwiseAbs2());
  posterior_ = std::make_shared<const MotionPosterior>(std::move(all));
  change_ = std::exchange(change_since_, {});
  refitted_ = std::exchange(refitted_since_, false);
}

}  // namespace slipwise
