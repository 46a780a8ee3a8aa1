// SPDX-License-Identifier: Apache-2.0
// A bank of small Kalman filters over the deviation of slip from what was learned (derivations.md, section 18).
#include "slipwise/estimate/coloured_slip.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>

#include "slipwise/estimate/causal_filter.hpp"
#include "slipwise/lie/angle.hpp"
#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise {
namespace {

constexpr std::array<std::string_view, 4> kWandering{"lon.V", "lat.V", "ang.w", "ang.V"};
constexpr auto kMost = static_cast<int>(kWandering.size());
constexpr double kGate = 16.266;  // 99.9 % of a chi-square of three degrees of freedom

using State = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMost, 1>;
using StateMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMost, kMost>;
using ByDeviation = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMost>;

/// A segment as it was expected without any deviation, and how a deviation would show in it.
struct Seen {
  double start;                ///< [s]
  double end;                  ///< [s]
  Eigen::Vector3d innovation;  ///< measured minus expected chart
  Eigen::Matrix3d noise;       ///< its covariance, were the parameters known
  ByDeviation by_deviation;
};

struct WanderingTerms {
  std::vector<Eigen::Index> places;  ///< of the parameters
  State prior_std;
  std::vector<bool> angular;
};

WanderingTerms wandering_terms(const MotionBelief& belief) {
  WanderingTerms terms;
  for (std::size_t i = 0; i < belief.model.basis().size(); ++i) {
    const std::string name = belief.model.basis().parameter_name(i);
    if (std::ranges::find(kWandering, name) != kWandering.end()) {
      terms.places.push_back(static_cast<Eigen::Index>(i));
      terms.angular.push_back(belief.model.basis().channel(i) == Channel::Ang);
    }
  }
  terms.prior_std = belief.prior_std(terms.places);
  return terms;
}

Seen see(const MotionBelief& belief, const WanderingTerms& terms, const InputTrack& inputs, const Segment& segment) {
  const auto at = linearize_segment(belief.model, belief.estimate.mean, inputs, segment);
  Eigen::Vector3d innovation = segment.measured.vector() - at.predicted.vector();
  innovation.z() = wrap_angle(innovation.z());
  return {segment.start, segment.end, innovation,
          segment_noise(at.path, at.predicted, belief.shape, belief.noise_scale),
          at.by_parameter(Eigen::all, terms.places)};
}

std::vector<Seen> see_all(const MotionBelief& belief, const WanderingTerms& terms, const InputTrack& inputs,
                          std::span<const Segment> segments) {
  std::vector<Seen> seen;
  for (const Segment& segment : segments) {
    seen.push_back(see(belief, terms, inputs, segment));
  }
  return seen;
}

/// The deviation under one candidate. It holds still within a segment and decays between their middles.
class Deviation {
 public:
  Deviation(const SlipWander& wander, const WanderingTerms& terms)
      : time_constant_(wander.time_constant), mean_(State::Zero(terms.prior_std.size())) {
    State variance(terms.prior_std.size());
    for (Eigen::Index i = 0; i < variance.size(); ++i) {
      const double fraction = terms.angular[static_cast<std::size_t>(i)] ? wander.turn : wander.drift;
      variance[i] = std::pow(fraction * terms.prior_std[i], 2);
    }
    usual_ = variance.asDiagonal();
    covariance_ = usual_;
  }

  void follow(const Seen& seen) {
    decay_to((seen.start + seen.end) / 2.0);
    const ByDeviation& h = seen.by_deviation;
    const Eigen::Vector3d innovation = seen.innovation - h * mean_;
    const Eigen::Matrix3d expected = h * covariance_ * h.transpose() + seen.noise;
    const double nis = innovation.dot(expected.llt().solve(innovation));
    const Eigen::Matrix3d doubted = std::max(1.0, nis / kGate) * expected;  // an outlier moves it no further
    const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::ColMajor, kMost, 3> gain =
        doubted.llt().solve(h * covariance_).transpose();
    mean_ += gain * innovation;
    covariance_ -= gain * h * covariance_;
    covariance_ = (covariance_ + covariance_.transpose()).eval() / 2.0;
  }

  /// Mean and covariance of its mean over [start, end], which follows all that it has seen.
  std::pair<State, StateMatrix> mean_over(double start, double end) const {
    const double spans = (end - start) / time_constant_;
    const double begun = std::exp(-std::max(0.0, start - t_) / time_constant_);
    const double kept = begun * (1.0 - std::exp(-spans)) / spans;
    const double usual = 2.0 / spans * (1.0 - (1.0 - std::exp(-spans)) / spans);  // variance of such a mean, of one
    return {kept * mean_, kept * kept * (covariance_ - usual_) + usual * usual_};
  }

 private:
  void decay_to(double t) {
    const double kept = known_ ? std::exp(-(t - t_) / time_constant_) : 0.0;
    mean_ *= kept;
    covariance_ = kept * kept * covariance_ + (1.0 - kept * kept) * usual_;
    t_ = t;
    known_ = true;
  }

  double time_constant_;
  double t_ = 0.0;
  bool known_ = false;
  State mean_;
  StateMatrix usual_;  ///< covariance before anything is seen
  StateMatrix covariance_;
};

Deviation followed(const SlipWander& wander, const WanderingTerms& terms, std::span<const Seen> recent) {
  Deviation deviation(wander, terms);
  for (const Seen& seen : recent) {
    deviation.follow(seen);
  }
  return deviation;
}

void check_positive(const std::vector<double>& values, const char* what) {
  if (values.empty()) {
    throw std::invalid_argument(std::string(what) + " of coloured slip must not be empty");
  }
  for (const double value : values) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      throw std::invalid_argument(std::string(what) + " of coloured slip must be positive and finite, got " +
                                  std::to_string(value));
    }
  }
}

}  // namespace

ColouredSlip::ColouredSlip(const ColouredSlipSettings& settings) : weighing_(settings.weighing) {
  check_positive(settings.fractions, "the fractions");
  check_positive(settings.time_constants, "the time constants");
  candidates_.push_back({0.0, 0.0, 1.0});
  std::vector<double> fractions = settings.fractions;
  fractions.insert(fractions.begin(), 0.0);
  for (const double time_constant : settings.time_constants) {
    for (const double drift : fractions) {
      for (const double turn : fractions) {
        if (drift > 0.0 || turn > 0.0) {
          candidates_.push_back({drift, turn, time_constant});
        }
      }
    }
  }
  const auto count = static_cast<Eigen::Index>(candidates_.size());
  prior_ = Eigen::VectorXd::Constant(count, (1.0 - settings.white) / static_cast<double>(count - 1));
  prior_[0] = settings.white;
  weights_ = prior_;
}

void ColouredSlip::learn(const MotionBelief& belief, const InputTrack& inputs, std::span<const Segment> segments) {
  const WanderingTerms terms = wandering_terms(belief);
  if (terms.places.empty() || segments.empty()) {
    return;
  }
  const std::vector<Seen> seen = see_all(belief, terms, inputs, segments);
  const Seen& next = seen.back();
  const auto before = std::span(seen).first(seen.size() - 1);
  Eigen::VectorXd scores(weights_.size());
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const State deviation = followed(candidates_[i], terms, before).mean_over(next.start, next.end).first;
    const Eigen::Vector3d innovation = next.innovation - next.by_deviation * deviation;
    const double nis = innovation.dot(next.noise.llt().solve(innovation));
    scores[static_cast<Eigen::Index>(i)] = student_log_score(nis, next.noise);  // judged by errors, as bases are
  }
  weights_ = reweighed(weights_, scores, prior_, weighing_, seen_);
  ++seen_;
}

ExpectedPose ColouredSlip::predict(const MotionBelief& belief, const InputTrack& inputs,
                                   std::span<const Segment> recent, const Segment& segment) const {
  const auto at = linearize_segment(belief.model, belief.estimate.mean, inputs, segment);
  ExpectedPose expected{at.predicted.vector(),
                        prediction_covariance(at, belief.estimate.covariance, belief.shape, belief.noise_scale)};
  const WanderingTerms terms = wandering_terms(belief);
  if (terms.places.empty()) {
    return expected;
  }
  const std::vector<Seen> seen = see_all(belief, terms, inputs, recent);
  const ByDeviation h = at.by_parameter(Eigen::all, terms.places);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const auto [deviation, covariance] = followed(candidates_[i], terms, seen).mean_over(segment.start, segment.end);
    const Eigen::Vector3d shift = h * deviation;
    const double weight = weights_[static_cast<Eigen::Index>(i)];
    mean += weight * shift;
    square += weight * (h * covariance * h.transpose() + shift * shift.transpose());
  }
  expected.pose += mean;
  expected.covariance += square - mean * mean.transpose();
  return expected;
}

}  // namespace slipwise
