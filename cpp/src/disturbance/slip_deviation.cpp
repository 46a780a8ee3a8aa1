// SPDX-License-Identifier: Apache-2.0
// A small Kalman filter over the deviation of slip from what was learned (derivations/uncertainty.md).
#include "slipwise/disturbance/slip_deviation.hpp"

#include <algorithm>
#include <cmath>

#include "slipwise/filter/linear_update.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kGate, 16.266);  // 99.9 % of a chi-square of three degrees of freedom

}  // namespace

SlipDeviation::SlipDeviation(const SlipDisturbance& disturbance, const DisturbedTerms& terms)
    : time_constant_(disturbance.time_constant), mean_(State::Zero(terms.size())) {
  nominal_ = terms.variances(disturbance).asDiagonal();
  covariance_ = nominal_;
}

void SlipDeviation::follow(const ObservedSlip& observed) {
  decay_to((observed.start + observed.end) / 2.0);
  const ObservedSlip::ByDeviation& h = observed.by_deviation;
  const Rows innovation = observed.innovation - h * mean_;
  const RowsCovariance expected = h * covariance_ * h.transpose() + observed.noise;
  const double larger = std::max(1.0, normalised_square(innovation, expected) / kGate) - 1.0;
  mean_ +=
      linear_update(covariance_, h, observed.noise + larger * expected) * innovation;  // an outlier moves it no further
}

std::pair<SlipDeviation::State, SlipDeviation::StateMatrix> SlipDeviation::mean_over(double start, double end) const {
  const double spans = (end - start) / time_constant_;
  const double kept = std::exp(-std::max(0.0, start - t_) / time_constant_) * kept_over(spans);
  return {kept * mean_, kept * kept * (covariance_ - nominal_) + variance_over(spans) * nominal_};
}

void SlipDeviation::decay_to(double t) {
  const double kept = known_ ? std::exp(-(t - t_) / time_constant_) : 0.0;
  mean_ *= kept;
  covariance_ = kept * kept * covariance_ + (1.0 - kept * kept) * nominal_;
  t_ = t;
  known_ = true;
}

}  // namespace slipwise
