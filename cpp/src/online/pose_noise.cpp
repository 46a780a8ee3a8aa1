// SPDX-License-Identifier: Apache-2.0
// A running mean of products of neighbours.
#include "slipwise/online/pose_noise.hpp"

#include <algorithm>
#include <cmath>

namespace slipwise {
namespace {

constexpr double kPrior = 20.0;       // poses that the first guess counts for
constexpr double kMemory = 400.0;     // poses after which the past is forgotten
constexpr double kMeanMemory = 50.0;  // of the mean error
constexpr double kLargest = 9.0;      // a product counts at most this many times the variance
constexpr double kLeast = 0.1;        // of the first standard deviation: no localiser is known to be without noise

}  // namespace

PoseNoise::PoseNoise(const PoseStd& first)
    : variance_(first.xy * first.xy, first.yaw * first.yaw),
      least_(kLeast * kLeast * variance_),
      mean_(Eigen::Vector3d::Zero()) {}

void PoseNoise::learn(const Eigen::Vector3d& error, const PoseStdRatio& ratio) {
  const Eigen::Vector3d above = error - mean_;
  if (last_) {
    const Eigen::Vector3d product = -above.cwiseProduct(*last_);
    const Eigen::Vector2d nominal(last_ratio_.xy * last_ratio_.xy, last_ratio_.yaw * last_ratio_.yaw);
    const Eigen::Vector2d found =
        Eigen::Vector2d((product.x() + product.y()) / 2.0, product.z()).cwiseQuotient(nominal);
    const Eigen::Vector2d bounded = found.cwiseMin(kLargest * variance_).cwiseMax(-kLargest * variance_);
    count_ = std::min(count_ + 1.0, kMemory);
    variance_ = (variance_ + (bounded - variance_) / (count_ + kPrior)).cwiseMax(least_);
    mean_ += above / std::min(count_ + kPrior, kMeanMemory);
  }
  last_ = above;
  last_ratio_ = ratio;
}

Eigen::Vector3d PoseNoise::variances(const PoseStdRatio& ratio) const {
  const double xy = variance_.x() * ratio.xy * ratio.xy;
  return {xy, xy, variance_.y() * ratio.yaw * ratio.yaw};
}

}  // namespace slipwise
