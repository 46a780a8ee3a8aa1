// SPDX-License-Identifier: Apache-2.0
// A posterior over a grid of variance scales and degrees of freedom.
#include "slipwise/online/student_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>
#include <stdexcept>

#include "slipwise/linear/tuning.hpp"
#include "slipwise/online/student_t.hpp"

namespace slipwise {
namespace {

// The prior: ln(scale) and ln(dof) are normal. A log of some ten predictions outweighs it.
SLIPWISE_TUNING(kPriorScaleStd, 0.7);  // of the logarithm, about 0
SLIPWISE_TUNING(kPriorDof, 8.0);
SLIPWISE_TUNING(kPriorDofStd, 0.8);
/// Errors after which one is forgotten; the last forgets nothing.
SLIPWISE_TUNING(kFastest, 10.0);
SLIPWISE_TUNED std::array kForgetting{kFastest, 3.0 * kFastest, 10.0 * kFastest,
                                      std::numeric_limits<double>::infinity()};
constexpr double kInner = 0.50;  // fractions whose ellipsoids the t reported takes over from the posterior
constexpr double kOuter = 0.95;
constexpr double kStep = 0.1;  // of the logarithms of scale and squared distance
constexpr Eigen::Index kScales = 116;
constexpr std::array kDofs{kLeastDof, 3.0, 4.0, 5.0, 7.0, 10.0, 15.0, 30.0, kMostDof};
constexpr Eigen::Index kDofCount = std::ssize(kDofs);
constexpr Eigen::Index kDistances = 196;
constexpr double kFarthest = 1e12;  // a squared distance counts at most this, so that it stays a number
constexpr Eigen::Index kFineDofs = 60;
constexpr Eigen::Index kFineDistances = 281;

double log_scale(Eigen::Index i) { return std::log(0.01) + kStep * static_cast<double>(i); }
double log_distance(Eigen::Index i) { return std::log(0.01) - 2.0 + kStep * static_cast<double>(i); }

/// Logarithms of squared distances, evenly spaced.
struct Axis {
  double first;
  double step;
  Eigen::Index count;
};

/// Where `inside`, the fraction within the distance of a place on the axis, rises to `fraction`.
template <typename Inside>
double crossing(const Inside& inside, double fraction, const Axis& axis) {
  const auto places = std::views::iota(Eigen::Index{1}, axis.count - 1);
  const Eigen::Index after =
      *std::ranges::partition_point(places, [&](Eigen::Index i) { return inside(i) < fraction; });
  const double low = inside(after - 1);
  return axis.first + axis.step * (static_cast<double>(after - 1) + (fraction - low) / (inside(after) - low));
}

/// What depends on the grid alone.
struct Tables {
  Eigen::VectorXd prior;                          ///< [scales * dofs] logarithms
  Eigen::VectorXd constant, power, per_distance;  ///< [scales * dofs] of the log density of an error
  Eigen::MatrixXd inside;                         ///< [scales * dofs, distances] fraction within each distance
  Eigen::VectorXd dof, inner, outer;              ///< [fine dofs] logarithms of the squared sizes of both ellipsoids

  Tables()
      : prior(kScales * kDofCount),
        constant(kScales * kDofCount),
        power(kScales * kDofCount),
        per_distance(kScales * kDofCount),
        inside(kScales * kDofCount, kDistances),
        dof(kFineDofs),
        inner(kFineDofs),
        outer(kFineDofs) {
    for (Eigen::Index d = 0; d < kDofCount; ++d) {
      const double nu = kDofs[static_cast<std::size_t>(d)];
      Eigen::VectorXd of_quotient(kScales + kDistances - 1);  // it depends on distance over scale alone
      for (Eigen::Index q = 0; q < of_quotient.size(); ++q) {
        const double logarithm = log_distance(0) - log_scale(0) + kStep * static_cast<double>(q + 1 - kScales);
        of_quotient[q] = fraction_inside((nu - 2.0) / nu * std::exp(logarithm), nu);
      }
      const double of_dof = std::lgamma((nu + 3.0) / 2.0) - std::lgamma(nu / 2.0) - 1.5 * std::log(nu);
      const double away = (std::log(nu) - std::log(kPriorDof)) / kPriorDofStd;
      for (Eigen::Index s = 0; s < kScales; ++s) {
        const Eigen::Index place = s * kDofCount + d;
        constant[place] = of_dof - 1.5 * log_scale(s);
        power[place] = 0.5 * (nu + 3.0);
        per_distance[place] = std::exp(-log_scale(s)) / nu;
        prior[place] = -0.5 * (std::pow(log_scale(s) / kPriorScaleStd, 2) + away * away);
        inside.row(place) = of_quotient.segment(kScales - 1 - s, kDistances);
      }
    }
    const double ratio = std::log(kMostDof / kLeastDof) / static_cast<double>(kFineDofs - 1);
    for (Eigen::Index d = 0; d < kFineDofs; ++d) {
      dof[d] = kLeastDof * std::exp(ratio * static_cast<double>(d));
      Eigen::VectorXd row(kFineDistances);
      for (Eigen::Index k = 0; k < kFineDistances; ++k) {
        row[k] = fraction_inside((dof[d] - 2.0) / dof[d] * std::exp(-2.0 + 0.025 * static_cast<double>(k)), dof[d]);
      }
      inner[d] = crossing(row, kInner, {.first = -2.0, .step = 0.025, .count = kFineDistances});
      outer[d] = crossing(row, kOuter, {.first = -2.0, .step = 0.025, .count = kFineDistances});
    }
  }
};

const Tables& tables() {
  static const Tables made;
  return made;
}

/// Linear interpolation between points whose first coordinates rise.
double interpolated(double x, const Eigen::VectorXd& rising, const Eigen::VectorXd& values) {
  Eigen::Index after = 1;
  while (after + 1 < rising.size() && rising[after] < x) {
    ++after;
  }
  const double part = std::clamp((x - rising[after - 1]) / (rising[after] - rising[after - 1]), 0.0, 1.0);
  return values[after - 1] + part * (values[after] - values[after - 1]);
}

/// Log density of an error over the grid, up to a constant.
Eigen::VectorXd log_likelihood(double squared) {
  const Tables& known = tables();
  return known.constant.array() -
         known.power.array() * (1.0 + std::min(squared, kFarthest) * known.per_distance.array()).log();
}

constexpr double kNegligible =
    40.0;  // less than the greatest logarithm by so much, all of a grid add less than rounding

/// Weights of the scales that count: those between are theirs too, for logarithms of densities are concave in that of
/// the scale.
GridWeights weights_of(const Eigen::VectorXd& logarithms) {
  const double most = logarithms.maxCoeff();
  const auto counts = [&](Eigen::Index place) { return logarithms[place] >= most - kNegligible; };
  Eigen::Index first = 0;
  Eigen::Index end = logarithms.size();
  while (first + 1 < end && !counts(first)) {
    ++first;
  }
  while (end > first + 1 && !counts(end - 1)) {
    --end;
  }
  GridWeights found{
      .first = first, .weights = (logarithms.segment(first, end - first).array() - most).exp(), .log_sum = 0.0};
  const double sum = found.weights.sum();
  found.weights /= sum;
  found.log_sum = most + std::log(sum);
  return found;
}

}  // namespace

StudentCalibration::StudentCalibration() {
  evidence_.fill(Eigen::VectorXd::Zero(kScales * kDofCount));
  weigh();
}

void StudentCalibration::check_sizes() const {
  if (std::ranges::any_of(evidence_, [](const auto& each) { return each.size() != kScales * kDofCount; })) {
    throw std::invalid_argument("the evidence of a calibration belongs to another grid");
  }
}

void StudentCalibration::weigh() {
  for (std::size_t k = 0; k < kForgettingTimes; ++k) {
    posterior_[k] = weights_of(tables().prior + evidence_[k]);
  }
}

void StudentCalibration::learn(double squared) {
  const Eigen::VectorXd step = log_likelihood(squared);
  for (std::size_t k = 0; k < kForgettingTimes; ++k) {
    predicted_[k] += weights_of(tables().prior + evidence_[k] + step).log_sum - posterior_[k].log_sum;
    evidence_[k] = (1.0 - 1.0 / kForgetting[k]) * evidence_[k] + step;
  }
  weigh();
}

/// Where the mixture's tails are heavier than the least degrees of freedom allow, the larger ellipsoid is kept.
StudentT StudentCalibration::fitted() const {
  const Tables& known = tables();
  const GridWeights of_times = weights_of(Eigen::Map<const Eigen::Vector4d>(predicted_.data()));
  Eigen::VectorXd mixed = Eigen::VectorXd::Zero(known.prior.size());
  for (Eigen::Index i = 0; i < of_times.weights.size(); ++i) {
    const GridWeights& each = posterior_[static_cast<std::size_t>(of_times.first + i)];
    mixed.segment(each.first, each.weights.size()) += of_times.weights[i] * each.weights;
  }
  const auto inside = [&](Eigen::Index distance) { return known.inside.col(distance).dot(mixed); };
  const Axis axis{.first = log_distance(0), .step = kStep, .count = kDistances};
  const double inner = crossing(inside, kInner, axis);
  const double outer = crossing(inside, kOuter, axis);
  const double dof = interpolated(inner - outer, known.inner - known.outer, known.dof);
  const double scale = std::exp(outer - interpolated(dof, known.dof, known.outer));
  return {.inflation = scale * dof / (dof - 2.0), .dof = dof};
}

}  // namespace slipwise
