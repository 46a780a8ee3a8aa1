// SPDX-License-Identifier: Apache-2.0
// A Gauss-Markov process and its means, interval by interval.
#include "slipwise/estimate/drive_noise.hpp"

#include <cmath>

namespace slipwise {

DriveNoiseMeans drive_noise_means(const DriveNoise& noise, std::span<const double> edges,
                                  std::span<const double> samples) {
  const auto count = std::ssize(samples);
  DriveNoiseMeans means{Eigen::VectorXd::Zero(count + 1), Eigen::MatrixXd::Zero(count + 1, count + 1)};
  auto& c = means.covariance;
  means.by_start[count] = 1.0;  // the last row is the deviation now
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const double spans = (edges[at + 1] - edges[at]) / noise.time_constant;
    const double gone = -std::expm1(-spans);
    const double kept = 1.0 - gone;
    const double mean = gone / spans;  // of the deviation at the interval's start
    const double own = noise.wander * (1.0 - kept * kept);
    const double crossed = noise.wander * gone * gone / spans;
    const double of_mean = 2.0 * noise.wander / (spans * spans) * (spans - 2.0 * gone + 0.5 * (1.0 - kept * kept));
    means.by_start[k] = mean * means.by_start[count];
    c.row(k) = mean * c.row(count);
    c(k, k) = mean * mean * c(count, count) + of_mean + noise.white / samples[at];
    c(k, count) = kept * mean * c(count, count) + crossed;
    c.col(k).head(k) = c.row(k).head(k).transpose();
    c.row(count).head(k) *= kept;
    c(count, k) = c(k, count);
    c(count, count) = kept * kept * c(count, count) + own;
    c.col(count).head(k) = c.row(count).head(k).transpose();
    means.by_start[count] *= kept;
  }
  return means;
}

}  // namespace slipwise
