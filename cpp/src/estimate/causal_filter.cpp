// SPDX-License-Identifier: Apache-2.0
// The causal filter of one model.
#include "slipwise/estimate/causal_filter.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "slipwise/estimate/heavy_tails.hpp"
#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/innovation.hpp"

namespace slipwise {
namespace {

constexpr double kSpeedChange = 0.1;  // the prior follows the speeds when their logarithm moves by more than this

constexpr std::size_t kFirst = 8, kLast = 256;  // segments after which, and each doubling, all are learned anew
constexpr std::size_t kHeeded = 64;             // segments from which only what is heard is learned anew
constexpr double kLittle = 0.03;                // of -2 log posterior: a sixth of a standard deviation
constexpr double kSameStamp = 1e-6;             // [s] segments closer than this meet at one pose

bool far_apart(double a, double b) { return std::abs(std::log(a / b)) > kSpeedChange; }

}  // namespace

CausalFilter::CausalFilter(MotionModel model, const CausalFilterSettings& settings)
    : model_(std::move(model)), settings_(settings), noise_scale_(settings.noise), scores_(model_) {
  follow({.v = 1.0, .omega = 1.0});
  started_ = false;
  stated_ = Eigen::VectorXd::Ones(model_.size());
}

void CausalFilter::follow(const ReferenceSpeeds& speeds) {
  Eigen::VectorXd std = slip_prior_std(model_.basis(), speeds, settings_.prior.slip_fraction);
  if (!started_) {
    estimate_ = before_ = prior_estimate(model_, speeds, settings_.prior);
  } else if (far_apart(speeds.v, speeds_.v) || far_apart(speeds.omega, speeds_.omega)) {
    std::optional<Estimate> changed = change_slip_prior(estimate_, slip_std_, std);
    std::optional<Estimate> before = change_slip_prior(before_, slip_std_, std);
    if (!changed || !before) {
      return;  // the old prior stays in force
    }
    estimate_ = std::move(*changed);
    before_ = std::move(*before);
  } else {
    return;
  }
  started_ = true;
  speeds_ = speeds;
  slip_std_ = std::move(std);
}

Eigen::VectorXd CausalFilter::prior_std() const {
  Estimate prior = prior_estimate(model_, speeds_, settings_.prior);
  return prior.covariance.diagonal().cwiseSqrt();
}

void CausalFilter::forget(double share) {
  const Eigen::Index slip = model_.slip_size();
  const double keep = std::sqrt(1.0 - share);
  estimate_.covariance.topRows(slip) *= keep;
  estimate_.covariance.leftCols(slip) *= keep;
  estimate_.covariance.diagonal().head(slip) += share * slip_std_.cwiseAbs2();
  scores_.restart();
  stated_.setOnes();
  noise_scale_.hurry();
  before_ = estimate_;
  kept_.clear();
  since_ = 0;
}

Estimate CausalFilter::stated() const {
  return {estimate_.mean, stated_.asDiagonal() * estimate_.covariance * stated_.asDiagonal()};
}

Eigen::Matrix3d CausalFilter::expected_noise(const SegmentLinearization& at, const Segment& segment) const {
  const MotionNoise& shape = settings_.noise.shape;
  return slip_covariance(at.path, shape) + pose_noise_covariance(segment.measured, shape);
}

/// `at` is the segment at the estimate.
void CausalFilter::learn_noise(const SegmentLinearization& at, const Segment& segment) {
  noise_scale_.learn(at, estimate_.covariance, segment.measured, expected_noise(at, segment).diagonal());
}

/// A parked robot tells nothing of the parameters, and nothing of the noise of driving.
void CausalFilter::keep(const InputTrack& inputs, const Segment& segment, const SegmentLinearization& at, bool heard) {
  if (since_ == kLast) {
    kept_ = {};
    return;
  }
  if (at.by_parameter.isZero(0.0)) {
    return;
  }
  ++since_;
  kept_.push_back({inputs, segment});
  if (since_ >= kFirst && std::has_single_bit(since_) && (heard || since_ < kHeeded)) {
    relearn();
  }
}

/// What is kept, but for what the gate leaves out.
struct CausalFilter::KeptData {
  std::vector<BatchDatum> data;
  std::vector<SegmentLinearization> at;  ///< at the estimate
  std::vector<std::size_t> places;       ///< among what is kept
};

/// The first segments were learned with a first guess of the noise, and linearised where little was known. Where the
/// fit does not settle, what was learned one by one stands.
void CausalFilter::relearn() {
  KeptData kept = kept_data();
  if (kept.data.empty() || !Cholesky(before_.covariance).positive_definite()) {
    return;
  }
  constexpr double kWeighed = std::numeric_limits<double>::infinity();
  const double expected_cost = 3.0 * static_cast<double>(kept.data.size());
  const BatchSettings settings{.tolerance = kLittle / expected_cost, .huber = kWeighed, .start = estimate_.mean};
  BatchFit fit = batch_fit(model_, before_, kept.data, settings, std::move(kept.at));
  if (fit.status != Status::Converged) {
    return;
  }
  estimate_ = std::move(fit.estimate);
  noise_scale_.restart();
  scores_.restart();
  std::size_t fitted = 0;
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    const auto& [inputs, segment] = kept_[i];
    if (fitted < kept.places.size() && kept.places[fitted] == i) {
      learn_noise(fit.at[fitted], segment);
      scores_.add(fit.at[fitted], estimate_.covariance, segment, kept.data[fitted].noise);
      ++fitted;
    } else {
      learn_noise(linearize_segment(model_, estimate_.mean, inputs, segment), segment);
    }
  }
}

/// Weighed by the rule of the IEKF. From wheels, neighbours share the noise of the pose where they meet; from commands,
/// what is not known of the drive there is far more.
CausalFilter::KeptData CausalFilter::kept_data() const {
  KeptData data;
  const Segment* last = nullptr;
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    const auto& [inputs, segment] = kept_[i];
    auto at = linearize_segment(model_, estimate_.mean, inputs, segment);
    const Eigen::Matrix3d noise = segment_noise(at.path, segment.measured, settings_.noise.shape, noise_scale_.value());
    const Eigen::Vector3d innovation = segment.measured.vector() - at.predicted.vector();
    const Eigen::Matrix3d covariance = at.by_parameter * estimate_.covariance * at.by_parameter.transpose() + noise;
    const double nis = normalised_square(innovation, covariance);
    if (!(nis <= settings_.iekf.gate)) {
      last = nullptr;
      continue;
    }
    Eigen::Matrix3d shared = Eigen::Matrix3d::Zero();
    if (!model_.learned().dynamics && last != nullptr && std::abs(segment.start - last->end) < kSameStamp) {
      shared = scaled_covariance(shared_pose_noise(segment.measured, last->measured, settings_.noise.shape),
                                 noise_scale_.value());
    }
    const double larger = std::max(std::sqrt(nis) / settings_.iekf.huber, 1.0);
    data.data.push_back({.inputs = &inputs, .segment = segment, .noise = noise * larger, .shared = shared});
    data.at.push_back(std::move(at));
    data.places.push_back(i);
    last = &segment;
  }
  return data;
}

IekfUpdate CausalFilter::learn(const InputTrack& inputs, const Segment& segment, const ReferenceSpeeds& speeds,
                               bool heard) {
  follow(speeds);
  auto at = linearize_segment(model_, estimate_.mean, inputs, segment);
  const Eigen::Matrix3d expected = expected_noise(at, segment);
  const Eigen::Matrix3d noise = scaled_covariance(expected, noise_scale_.value());
  IekfUpdate update = iekf_update(model_, estimate_, inputs, segment, std::move(at), noise, settings_.iekf);
  estimate_ = update.estimate;
  noise_scale_.learn(update.at, estimate_.covariance, segment.measured, expected.diagonal());
  if (update.weight > 0.0) {
    scores_.add(update.at, estimate_.covariance, segment, noise / update.weight);
  }
  keep(inputs, segment, update.at, heard);
  if (settings_.noise.adapt) {
    stated_ = scores_.std_factors(before_.covariance, estimate_.covariance);
  }
  return update;
}

Eigen::Matrix3d prediction_covariance(const SegmentLinearization& at,
                                      const Eigen::Ref<const Eigen::MatrixXd>& parameters, const MotionNoise& shape,
                                      const Eigen::Vector3d& scale) {
  return at.by_parameter * parameters * at.by_parameter.transpose() +
         segment_noise(at.path, at.predicted, shape, scale);
}

}  // namespace slipwise
