// SPDX-License-Identifier: Apache-2.0
// Moments of a mixture, stretch by stretch and between stretches.
#include "slipwise/slip/mixed_ahead.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "slipwise/linear/symmetric_eigen.hpp"

namespace slipwise {
namespace {

constexpr double kRounding = 1e-6;
constexpr double kNegligible = 1e-12;  // of the largest variance

/// Columns whose sum of squares is the covariance, without those that say nothing.
std::vector<Eigen::VectorXd> columns_of(const Eigen::MatrixXd& covariance) {
  const Eigen::MatrixXd root = covariance_root(covariance);
  const Eigen::VectorXd squares = root.colwise().squaredNorm();
  std::vector<Eigen::VectorXd> columns;
  for (Eigen::Index j = 0; j < root.cols(); ++j) {
    if (squares[j] > kNegligible * squares.maxCoeff()) {
      columns.emplace_back(root.col(j));
    }
  }
  return columns;
}

void check(const std::vector<double>& edges, const Eigen::Ref<const Eigen::MatrixXd>& probabilities,
           std::span<const SurfaceMoments> surfaces) {
  if (surfaces.empty() || probabilities.cols() != std::ssize(surfaces) ||
      probabilities.rows() != std::ssize(edges) + 1) {
    throw std::invalid_argument("the surfaces ahead need a probability for each stretch and surface");
  }
  const bool distributions = probabilities.allFinite() && (probabilities.array() >= 0.0).all() &&
                             ((probabilities.rowwise().sum().array() - 1.0).abs() <= kRounding).all();
  if (!distributions) {
    throw std::invalid_argument("the probabilities of surfaces ahead must add up to 1 in each stretch");
  }
  const Eigen::Index size = surfaces.front().slip.size();
  for (const SurfaceMoments& each : surfaces) {
    if (each.slip.size() != size || each.covariance.rows() != size || each.covariance.cols() != size ||
        !each.slip.allFinite() || !each.covariance.allFinite()) {
      throw std::invalid_argument("surfaces ahead have slip in the same terms, with a finite covariance");
    }
  }
}

}  // namespace

MixedAhead mix_ahead(std::vector<double> edges, const Eigen::Ref<const Eigen::MatrixXd>& probabilities,
                     std::span<const SurfaceMoments> surfaces) {
  check(edges, probabilities, surfaces);
  const Eigen::Index size = surfaces.front().slip.size();
  const Eigen::Index stretches = probabilities.rows();
  Eigen::MatrixXd means = Eigen::MatrixXd::Zero(size, stretches);
  MixedAhead mixed;
  mixed.noise_scale.setZero(stretches, 3);
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const auto likely = probabilities.col(static_cast<Eigen::Index>(s));
    mixed.noise_scale += likely * surfaces[s].noise_scale.transpose();
    means += surfaces[s].slip * likely.transpose();
    for (const Eigen::VectorXd& column : columns_of(surfaces[s].covariance)) {
      if (!likely.isZero(0.0)) {
        mixed.directions.emplace_back(column * likely.transpose());
      }
    }
  }
  for (Eigen::Index k = 0; k < stretches; ++k) {  // which surface it is, and what the common part leaves out
    Eigen::MatrixXd rest = Eigen::MatrixXd::Zero(size, size);
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
      const double p = probabilities(k, static_cast<Eigen::Index>(s));
      const Eigen::VectorXd away = surfaces[s].slip - means.col(k);
      rest += p * (1.0 - p) * surfaces[s].covariance + p * away * away.transpose();
    }
    for (const Eigen::VectorXd& column : rest.isZero(0.0) ? std::vector<Eigen::VectorXd>{} : columns_of(rest)) {
      mixed.directions.emplace_back(Eigen::MatrixXd::Zero(size, stretches));
      mixed.directions.back().col(k) = column;
    }
  }
  mixed.slip = means.col(0);
  mixed.ahead.edges = std::move(edges);
  for (Eigen::Index k = 1; k < stretches; ++k) {
    mixed.ahead.changes.emplace_back(means.col(k) - means.col(k - 1));
  }
  check_ahead(mixed.ahead, size);
  return mixed;
}

Eigen::Vector3d MixedAhead::noise_scale_until(double travelled) const {
  const auto reached = std::ranges::lower_bound(ahead.edges, travelled) - ahead.edges.begin();
  return noise_scale.topRows(1 + reached).colwise().maxCoeff();
}

}  // namespace slipwise
