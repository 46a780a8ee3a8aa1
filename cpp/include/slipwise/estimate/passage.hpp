// SPDX-License-Identifier: Apache-2.0
// A stretch of a process seen from its start: what is measured on the way and where it ends, with common noise
// (derivations.md, section 6).
#pragma once

#include <Eigen/Core>
#include <functional>

#include "slipwise/estimate/estimate.hpp"
#include "slipwise/estimate/iekf.hpp"

namespace slipwise {

/// Linearised at a state at the start. The first rows are what is measured, those after them the state at the end.
struct Passage {
  Eigen::Index measured;  ///< M
  Eigen::VectorXd value;  ///< [M + N]
  Eigen::MatrixXd slope;  ///< [M + N, N] by the state at the start
  Eigen::MatrixXd noise;  ///< [M + N, M + N] covariance of what adds to it, the cross-covariances included

  auto seen() const { return value.head(measured); }
  auto seen_slope() const { return slope.topRows(measured); }
  auto seen_noise() const { return noise.topLeftCorner(measured, measured); }
};

/// The passage from a state at the start on.
using Foretell = std::function<Passage(const Eigen::VectorXd& state)>;

/// A state at the start, and the passage from there.
struct PassagePoint {
  Eigen::VectorXd state;
  Passage at;
};

/// S = H P H^T + R of what is measured.
Eigen::MatrixXd innovation_covariance(const Estimate& prior, const Passage& at);

/// The most probable state at the start, given the prior and what was measured: from `expected`, the passage of the
/// prior's mean. Where not even the first step helps, that mean.
PassagePoint settle(const Estimate& prior, Passage expected, const Foretell& foretell, const Eigen::VectorXd& measured,
                    const IekfSettings& settings);

/// The state at the start given what was measured, its covariance alone.
Eigen::MatrixXd start_covariance(const Estimate& prior, const Passage& at);

/// The state at the end given what was measured, from the linearisation at `point`, in Joseph form.
Estimate end_estimate(const Estimate& prior, const PassagePoint& point, const Eigen::VectorXd& measured);

}  // namespace slipwise
