// SPDX-License-Identifier: Apache-2.0
// Prediction of a steady drive and the linear variance equation along it (thesis 4.2 to 4.8 with dt counted once).
#include "slipwise/thesis/steady_segment.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace slipwise {
namespace {

constexpr double kLongestStep = 0.25;                                                     // [s] of the quadrature
constexpr std::array<double, 3> kNodes{0.112701665379258311, 0.5, 0.887298334620741689};  // Gauss-Legendre on 0..1
constexpr std::array<double, 3> kWeights{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};

Eigen::Vector3d tangent_of(const BodyTwist& twist, double time) {
  return Eigen::Vector3d(twist.v, twist.vy, twist.omega) * time;
}

void check_times(std::span<const double> times) {
  double last = 0.0;
  for (const double t : times) {
    if (!(t > last) || !std::isfinite(t)) {
      throw std::invalid_argument("times must be finite, positive and increasing");
    }
    last = t;
  }
}

/// Spread that white noise of each channel adds between two times, observed at the later one, per unit of its density.
std::array<Eigen::Matrix3d, 3> added_spread(const BodyTwist& twist, double from, double to) {
  std::array<Eigen::Matrix3d, 3> added;
  added.fill(Eigen::Matrix3d::Zero());
  const Pose2 end = steady_pose(twist, to);
  const int steps = std::max(1, static_cast<int>(std::ceil((to - from) / kLongestStep)));
  const double step = (to - from) / steps;
  for (int k = 0; k < steps; ++k) {
    for (std::size_t node = 0; node < kNodes.size(); ++node) {
      const Pose2 at = steady_pose(twist, from + (k + kNodes[node]) * step);
      Eigen::Matrix3d effect = Eigen::Matrix3d::Identity();  // Gamma of (4.5)
      effect.topLeftCorner<2, 2>() = rotation(at.theta);
      effect = (transition(at, end) * effect).eval();
      for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::Vector3d column = effect.col(static_cast<Eigen::Index>(i));
        added[i] += kWeights[node] * step * column * column.transpose();
      }
    }
  }
  return added;
}

}  // namespace

Pose2 steady_pose(const BodyTwist& twist, double time) { return exp(tangent_of(twist, time)); }

Eigen::Matrix3d steady_jacobian(const BodyTwist& twist, double time) {
  return chart_jacobian(tangent_of(twist, time)) * time;
}

std::array<Eigen::MatrixXd, 6> steady_covariance_parts(const BodyTwist& twist, std::span<const double> times) {
  check_times(times);
  const auto count = static_cast<Eigen::Index>(times.size());
  std::array<Eigen::MatrixXd, 6> parts;
  parts.fill(Eigen::MatrixXd::Zero(3 * count, 3 * count));
  std::array<Eigen::Matrix3d, 6> now;  // covariance at the time that is reached
  now.fill(Eigen::Matrix3d::Zero());
  for (Eigen::Index i = 0; i < 3; ++i) {
    now[static_cast<std::size_t>(3 + i)](i, i) = 1.0;
  }
  double before = 0.0;
  for (Eigen::Index k = 0; k < count; ++k) {
    const double time = times[static_cast<std::size_t>(k)];
    const Eigen::Matrix3d phi = transition(steady_pose(twist, before), steady_pose(twist, time));
    const auto added = added_spread(twist, before, time);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      now[i] = (phi * now[i] * phi.transpose()).eval();
      if (i < 3) {
        now[i] += added[i];
      }
      if (k > 0) {  // Cov(earlier, now) = Cov(earlier, before) Phi^T
        parts[i].block(0, 3 * k, 3 * k, 3) = parts[i].block(0, 3 * (k - 1), 3 * k, 3) * phi.transpose();
        parts[i].block(3 * k, 0, 3, 3 * k) = parts[i].block(0, 3 * k, 3 * k, 3).transpose();
      }
      parts[i].block<3, 3>(3 * k, 3 * k) = now[i];
    }
    before = time;
  }
  return parts;
}

Eigen::MatrixXd steady_covariance(const BodyTwist& twist, std::span<const double> times, const SteadyNoise& noise) {
  const auto parts = steady_covariance_parts(twist, times);
  const auto count = static_cast<Eigen::Index>(times.size());
  Eigen::MatrixXd covariance = noise.pose.replicate(count, 1).asDiagonal();
  for (Eigen::Index i = 0; i < 3; ++i) {
    covariance += noise.psd[i] * parts[static_cast<std::size_t>(i)];
    covariance += noise.start[i] * parts[static_cast<std::size_t>(3 + i)];
  }
  return covariance;
}

}  // namespace slipwise
