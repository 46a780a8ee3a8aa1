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
  Eigen::VectorXd prior;              ///< [scales * dofs] logarithms
  Eigen::MatrixXd inside;             ///< [scales * dofs, distances] fraction within each distance
  Eigen::VectorXd dof, inner, outer;  ///< [fine dofs] logarithms of the squared sizes of both ellipsoids

  Tables()
      : prior(kScales * kDofCount),
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
      const double away = (std::log(nu) - std::log(kPriorDof)) / kPriorDofStd;
      for (Eigen::Index s = 0; s < kScales; ++s) {
        prior[s * kDofCount + d] = -0.5 * (std::pow(log_scale(s) / kPriorScaleStd, 2) + away * away);
        inside.row(s * kDofCount + d) = of_quotient.segment(kScales - 1 - s, kDistances);
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
  Eigen::VectorXd density(kScales * kDofCount);
  std::array<double, kDofs.size()> constant{};
  for (std::size_t d = 0; d < kDofs.size(); ++d) {
    constant[d] = std::lgamma((kDofs[d] + 3.0) / 2.0) - std::lgamma(kDofs[d] / 2.0) - 1.5 * std::log(kDofs[d]);
  }
  for (Eigen::Index s = 0; s < kScales; ++s) {
    const double distance = std::min(squared, kFarthest) * std::exp(-log_scale(s));
    for (Eigen::Index d = 0; d < kDofCount; ++d) {
      const auto i = static_cast<std::size_t>(d);
      density[s * kDofCount + d] =
          constant[i] - 0.5 * (kDofs[i] + 3.0) * std::log1p(distance / kDofs[i]) - 1.5 * log_scale(s);
    }
  }
  return density;
}

Eigen::VectorXd normalised(const Eigen::VectorXd& logarithms) {
  const Eigen::VectorXd weights = (logarithms.array() - logarithms.maxCoeff()).exp();
  return weights / weights.sum();
}

}  // namespace

StudentCalibration::StudentCalibration() { evidence_.fill(Eigen::VectorXd::Zero(kScales * kDofCount)); }

void StudentCalibration::check_sizes() const {
  if (std::ranges::any_of(evidence_, [](const auto& each) { return each.size() != kScales * kDofCount; })) {
    throw std::invalid_argument("the evidence of a calibration belongs to another grid");
  }
}

void StudentCalibration::learn(double squared) {
  const Eigen::VectorXd step = log_likelihood(squared);
  const double most = step.maxCoeff();
  const Eigen::ArrayXd density = (step.array() - most).exp();
  for (std::size_t k = 0; k < kForgettingTimes; ++k) {
    predicted_[k] += std::log((normalised(tables().prior + evidence_[k]).array() * density).sum()) + most;
    evidence_[k] = (1.0 - 1.0 / kForgetting[k]) * evidence_[k] + step;
  }
}

/// Where the mixture's tails are heavier than the least degrees of freedom allow, the larger ellipsoid is kept.
StudentT StudentCalibration::fitted() const {
  const Tables& known = tables();
  const Eigen::VectorXd weights = normalised(Eigen::Map<const Eigen::Vector4d>(predicted_.data()));
  Eigen::VectorXd mixed = Eigen::VectorXd::Zero(known.prior.size());
  for (std::size_t k = 0; k < kForgettingTimes; ++k) {
    mixed += weights[static_cast<Eigen::Index>(k)] * normalised(known.prior + evidence_[k]);
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
