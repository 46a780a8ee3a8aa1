// SPDX-License-Identifier: Apache-2.0
// Sizes, spreads and ratios of the currents of one window.
#include "slipwise/terrain/current_features.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace slipwise {
namespace {

// What is added below a logarithm, the sensors' steps: [A], [A], [m/s].
constexpr double kAmperes = 0.3, kRipple = 0.1, kSpeed = 0.05;
constexpr double kConstant = 1e-9;  // [A^2] of spreads that have no correlation

double std_of(const Eigen::VectorXd& values) { return std::sqrt((values.array() - values.mean()).square().mean()); }

double correlation(const Eigen::VectorXd& left, const Eigen::VectorXd& right) {
  const double spread = std_of(left) * std_of(right);
  if (spread < kConstant) {
    return 0.0;
  }
  return ((left.array() - left.mean()) * (right.array() - right.mean())).mean() / spread;
}

}  // namespace

Eigen::VectorXd current_features(const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  if (samples.cols() != kDriveColumns || samples.rows() < 2) {
    throw std::invalid_argument("currents are described by two rows or more of left and right current and speed, got " +
                                std::to_string(samples.rows()) + " by " + std::to_string(samples.cols()));
  }
  const Eigen::VectorXd left = samples.col(0).cwiseAbs();
  const Eigen::VectorXd right = samples.col(1).cwiseAbs();
  const Eigen::VectorXd total = left + right;
  const Eigen::VectorXd change = total.tail(total.size() - 1) - total.head(total.size() - 1);
  const double speed_left = samples.col(2).cwiseAbs().mean();
  const double speed_right = samples.col(3).cwiseAbs().mean();
  const auto log_of = [](double value, double least) { return std::log(value + least); };
  Eigen::VectorXd found(kCurrentFeatures);
  Eigen::Index at = 0;
  for (const Eigen::VectorXd* side : {&left, &right}) {
    found[at++] = log_of(side->mean(), kAmperes);
    found[at++] = log_of(std_of(*side), kRipple);
    found[at++] = side->minCoeff();
    found[at++] = log_of(side->maxCoeff(), kAmperes);
  }
  found[at++] = log_of(total.mean(), kAmperes);
  found[at++] = log_of(std_of(total), kRipple);
  found[at++] = log_of(std_of(change), kRipple);
  found[at++] = log_of(left.mean(), kAmperes) - log_of(right.mean(), kAmperes);
  found[at++] = log_of(total.mean(), kAmperes) - log_of(speed_left + speed_right, kSpeed);
  found[at++] = log_of(left.mean(), kAmperes) - log_of(speed_left, kSpeed);
  found[at++] = log_of(right.mean(), kAmperes) - log_of(speed_right, kSpeed);
  found[at] = correlation(left, right);
  return found;
}

}  // namespace slipwise
