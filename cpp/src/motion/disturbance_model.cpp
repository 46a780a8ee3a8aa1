// SPDX-License-Identifier: Apache-2.0
// Which terms have a disturbance, and how far their mean over some time may be from what was learned.
#include "slipwise/motion/disturbance_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>

namespace slipwise {
namespace {

constexpr std::array<std::string_view, kMostDisturbed> kDisturbed{"lon.V", "lat.V", "ang.w", "ang.V"};
constexpr double kSure = 0.75;      // of the weight; from there on slip lasts longer than usual
constexpr double kFewSpans = 1e-3;  // below it two terms of the series are exact to 1e-10

bool is_amount(double value) { return value >= 0.0 && std::isfinite(value); }

}  // namespace

Eigen::VectorXd DisturbedTerms::variances(const SlipDisturbance& disturbance) const {
  Eigen::VectorXd result(size());
  for (Eigen::Index i = 0; i < size(); ++i) {
    const double fraction =
        channels[static_cast<std::size_t>(i)] == Channel::Ang ? disturbance.angular : disturbance.linear;
    result[i] = std::pow(fraction * prior_std[i], 2);
  }
  return result;
}

DisturbedTerms disturbed_terms(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& prior_std) {
  if (prior_std.size() != model.size()) {
    throw std::invalid_argument("a slip disturbance has a fraction of its prior: " + std::to_string(model.size()) +
                                " prior standard deviations are needed, got " + std::to_string(prior_std.size()));
  }
  DisturbedTerms terms;
  for (std::size_t i = 0; i < model.basis().size(); ++i) {
    const std::string name = model.basis().parameter_name(i);
    if (std::ranges::find(kDisturbed, name) != kDisturbed.end()) {
      terms.places.push_back(static_cast<Eigen::Index>(i));
      terms.channels.push_back(model.basis().channel(i));
      terms.of_turn.push_back(name == "ang.w");
    }
  }
  terms.prior_std = prior_std(terms.places);
  return terms;
}

double correlation_time(const DisturbanceModel& law, double usual) {
  double longer = 0.0;
  double excess = 0.0;
  for (std::size_t i = 0; i < law.candidates.size(); ++i) {
    const SlipDisturbance& candidate = law.candidates[i];
    const bool differs = candidate.linear > 0.0 || candidate.angular > 0.0;
    if (differs && candidate.time_constant > usual) {
      const double weight = law.weights[static_cast<Eigen::Index>(i)];
      longer += weight;
      excess += weight * (candidate.time_constant - usual);
    }
  }
  return longer > kSure ? usual + (longer - kSure) / (1.0 - kSure) * excess / longer : usual;
}

double kept_over(double spans) { return spans > 0.0 ? -std::expm1(-spans) / spans : 1.0; }

double variance_over(double spans) {
  return spans < kFewSpans ? 1.0 - spans / 3.0 + spans * spans / 12.0 : 2.0 / spans * (1.0 - kept_over(spans));
}

Eigen::VectorXd nominal_variances(const DisturbanceModel& law, const DisturbedTerms& terms, double seconds) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(terms.size());
  for (std::size_t i = 0; i < law.candidates.size(); ++i) {
    const SlipDisturbance& disturbance = law.candidates[i];
    const double weight = law.weights[static_cast<Eigen::Index>(i)];
    sum += weight * variance_over(seconds / disturbance.time_constant) * terms.variances(disturbance);
  }
  return sum;
}

Eigen::MatrixXd covariance_over(const MotionModel& model, const Eigen::Ref<const Eigen::MatrixXd>& learned,
                                const DisturbanceModel& law, const Eigen::Ref<const Eigen::VectorXd>& prior_std,
                                double seconds) {
  const DisturbedTerms terms = disturbed_terms(model, prior_std);
  Eigen::MatrixXd covariance = learned;
  covariance.diagonal()(terms.places) += nominal_variances(law, terms, seconds);
  return covariance;
}

void check_disturbance(const DisturbanceModel& law) {
  const auto count = static_cast<Eigen::Index>(law.candidates.size());
  if (law.weights.size() != count) {
    throw std::invalid_argument("the slip disturbance needs one weight per candidate: " + std::to_string(count) +
                                " candidates, " + std::to_string(law.weights.size()) + " weights");
  }
  for (const SlipDisturbance& disturbance : law.candidates) {
    if (!is_amount(disturbance.linear) || !is_amount(disturbance.angular) || !is_amount(disturbance.time_constant) ||
        disturbance.time_constant == 0.0) {
      throw std::invalid_argument(
          "a slip disturbance has fractions that are not negative, with a positive time constant");
    }
  }
  if (count > 0 && (!(law.weights.array() >= 0.0).all() || !(std::abs(law.weights.sum() - 1.0) <= 1e-6))) {
    throw std::invalid_argument("the weights of the slip disturbance must not be negative, and sum to 1");
  }
}

}  // namespace slipwise
