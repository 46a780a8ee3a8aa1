// SPDX-License-Identifier: Apache-2.0
// Least squares with the exact Jacobian over all poses of all segments of a group.
#include "slipwise/thesis/slip_rate_fit.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <stdexcept>
#include <string>

#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/gauss_newton.hpp"

namespace slipwise {
namespace {

using Columns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>;

BodyTwist with_slip(const BodyTwist& command, const Eigen::Vector3d& slip) {
  return {.v = command.v + slip.x(), .vy = command.vy + slip.y(), .omega = command.omega + slip.z()};
}

void check(std::span<const SteadySegment> segments, const SlipRateSettings& settings) {
  if (segments.empty() || (segments.size() < 2 && !settings.noise)) {
    throw std::invalid_argument("a group needs at least two segments to tell how sure its slip rates are, got " +
                                std::to_string(segments.size()) + "; join groups, or give the noise");
  }
  if (!(settings.length > 0.0)) {
    throw std::invalid_argument("the characteristic length must be positive");
  }
  for (std::size_t j = 0; j < segments.size(); ++j) {
    const SteadySegment& segment = segments[j];
    const std::string name = "segment " + std::to_string(j);
    if (segment.poses.size() < 2 || segment.times.size() != segment.poses.size()) {
      throw std::invalid_argument(name + " needs at least two poses with a time each, got " +
                                  std::to_string(segment.poses.size()));
    }
    for (std::size_t k = 0; k < segment.times.size(); ++k) {
      const bool ordered = k == 0 ? segment.times[0] == 0.0 : segment.times[k] > segment.times[k - 1];
      if (!ordered || !std::isfinite(segment.times[k]) || !segment.poses[k].vector().allFinite()) {
        throw std::invalid_argument(name + " must have finite poses at times that start at 0 and increase");
      }
    }
  }
}

/// Whitens stacked charts: by 1, 1, L as in (4.1), or by the Cholesky factor of the propagated covariance.
class Whitening {
 public:
  Whitening(const SteadySegment& segment, const Eigen::Vector3d& slip, const SlipRateSettings& settings)
      : length_(settings.length), weighted_(settings.noise.has_value()) {
    if (weighted_) {
      const std::span<const double> times(segment.times.begin() + 1, segment.times.end());
      factor_.compute(steady_covariance(with_slip(segment.command, slip), times, *settings.noise));
      if (factor_.info() != Eigen::Success) {
        throw std::invalid_argument(
            "the noise gives a covariance that is not positive definite; every channel needs some");
      }
    }
  }

  void apply(Columns& stacked) const {
    if (weighted_) {
      factor_.matrixL().solveInPlace(stacked);
      return;
    }
    for (Eigen::Index row = 2; row < stacked.rows(); row += 3) {
      stacked.row(row) *= length_;
    }
  }

 private:
  double length_;
  bool weighted_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

struct Whitened {
  Eigen::VectorXd residual;
  Columns jacobian;  ///< of the prediction, [3 (N - 1), 2 or 3]
};

class GroupProblem {
 public:
  GroupProblem(std::span<const SteadySegment> segments, const SlipRateSettings& settings, const Eigen::Vector3d& slip)
      : segments_(segments), unknowns_(settings.angular ? 3 : 2) {
    whitenings_.reserve(segments.size());
    for (const SteadySegment& segment : segments) {
      whitenings_.emplace_back(segment, slip, settings);
    }
  }

  Eigen::Index unknowns() const { return unknowns_; }

  Eigen::VectorXd residual(std::size_t j, const Eigen::Vector3d& slip) const {
    Columns stacked = steady_residuals(segments_[j], slip).reshaped();
    whitenings_[j].apply(stacked);
    return stacked;
  }

  double cost(const Eigen::Vector3d& slip) const {
    double sum = 0.0;
    for (std::size_t j = 0; j < segments_.size(); ++j) {
      sum += residual(j, slip).squaredNorm();
    }
    return sum;
  }

  Whitened linearize(std::size_t j, const Eigen::Vector3d& slip) const {
    const SteadySegment& segment = segments_[j];
    Columns jacobian(3 * static_cast<Eigen::Index>(segment.times.size() - 1), unknowns_);
    for (std::size_t k = 1; k < segment.times.size(); ++k) {
      jacobian.middleRows(3 * static_cast<Eigen::Index>(k - 1), 3) =
          steady_jacobian(with_slip(segment.command, slip), segment.times[k]).leftCols(unknowns_);
    }
    whitenings_[j].apply(jacobian);
    return {.residual = residual(j, slip), .jacobian = std::move(jacobian)};
  }

  /// Normal equations; `spread` gathers the outer products of the segments' gradients.
  struct Equations {
    Eigen::MatrixXd information;
    Eigen::VectorXd gradient;
    Eigen::MatrixXd spread;
  };
  Equations equations(const Eigen::Vector3d& slip) const {
    Equations sum{Eigen::MatrixXd::Zero(unknowns_, unknowns_), Eigen::VectorXd::Zero(unknowns_),
                  Eigen::MatrixXd::Zero(unknowns_, unknowns_)};
    for (std::size_t j = 0; j < segments_.size(); ++j) {
      const Whitened at = linearize(j, slip);
      const Eigen::VectorXd gradient = at.jacobian.transpose() * at.residual;
      sum.information += at.jacobian.transpose() * at.jacobian;
      sum.gradient += gradient;
      sum.spread += gradient * gradient.transpose();
    }
    return sum;
  }

 private:
  std::span<const SteadySegment> segments_;
  Eigen::Index unknowns_;
  std::vector<Whitening> whitenings_;
};

/// Poses of one segment err together, so the covariance of (4.1) is that of whole segments (a sandwich).
Eigen::MatrixXd covariance_of(const GroupProblem::Equations& at, std::size_t segments, bool weighted) {
  Eigen::MatrixXd inverse = Cholesky(at.information).inverse();
  if (weighted) {
    return inverse;
  }
  const auto n = static_cast<double>(segments);
  return n / (n - 1.0) * inverse * at.spread * inverse;
}

/// A yaw slip that brings the unwrapped headings near, so that no residual wraps into another turn.
Eigen::Vector3d first_guess(std::span<const SteadySegment> segments, bool angular) {
  double sum = 0.0;
  for (const SteadySegment& segment : segments) {
    sum += segment.poses.back().theta / segment.times.back() - segment.command.omega;
  }
  return {0.0, 0.0, angular ? sum / static_cast<double>(segments.size()) : 0.0};
}

SlipRateFit minimise(const GroupProblem& problem, const Eigen::Vector3d& start, const SlipRateSettings& settings) {
  SlipRateFit fit{start, Eigen::Matrix3d::Zero(), 0.0, Eigen::Vector3d::Zero(), {}, 0, Status::NotConverged};
  const Eigen::Index size = problem.unknowns();
  GaussNewton search(start.head(size), {.iterations = settings.iterations, .relative = settings.tolerance});
  NormalEquations at_best;
  while (!search.over()) {
    fit.slip.head(size) = search.candidate();
    if (search.judge(problem.cost(fit.slip))) {
      const auto at = problem.equations(fit.slip);
      at_best = {at.information, at.gradient};
    }
    search.propose(at_best);
  }
  fit.slip.head(size) = search.best();
  fit.cost = search.cost();
  fit.iterations = search.iterations();
  fit.status = search.converged() ? Status::Converged : fit.status;
  return fit;
}

}  // namespace

Eigen::Matrix3Xd steady_residuals(const SteadySegment& segment, const Eigen::Vector3d& slip) {
  Eigen::Matrix3Xd residuals(3, static_cast<Eigen::Index>(segment.times.size()) - 1);
  const BodyTwist twist = with_slip(segment.command, slip);
  for (Eigen::Index k = 0; k < residuals.cols(); ++k) {
    const auto i = static_cast<std::size_t>(k + 1);
    residuals.col(k) = segment.poses[i].vector() - steady_pose(twist, segment.times[i]).vector();
    residuals(2, k) = wrap_angle(residuals(2, k));
  }
  return residuals;
}

SlipRateFit fit_slip_rates(std::span<const SteadySegment> segments, const SlipRateSettings& settings) {
  check(segments, settings);
  SlipRateSettings plain = settings;
  plain.noise.reset();
  Eigen::Vector3d start = first_guess(segments, settings.angular);
  if (settings.noise) {  // the covariance belongs to the path as it was driven
    start = minimise(GroupProblem(segments, plain, start), start, plain).slip;
  }
  const GroupProblem problem(segments, settings, start);
  SlipRateFit fit = minimise(problem, start, settings);
  const Eigen::Index size = problem.unknowns();
  fit.covariance.topLeftCorner(size, size) =
      covariance_of(problem.equations(fit.slip), segments.size(), settings.noise.has_value());
  double count = 0.0;
  for (const SteadySegment& segment : segments) {
    fit.residuals.push_back(steady_residuals(segment, fit.slip));
    fit.rms += fit.residuals.back().rowwise().squaredNorm();
    count += static_cast<double>(fit.residuals.back().cols());
  }
  fit.rms = (fit.rms / count).cwiseSqrt();
  return fit;
}

}  // namespace slipwise
