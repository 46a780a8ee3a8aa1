// SPDX-License-Identifier: Apache-2.0
// A Gauss-Markov process and its means, interval by interval.
#include "slipwise/identify/actuator_noise.hpp"

#include <cmath>

namespace slipwise {

ActuatorNoiseInterval actuator_noise_interval(const ActuatorNoise& noise, double duration, double samples) {
  const double spans = duration / noise.time_constant;
  const double gone = -std::expm1(-spans);
  const double kept = 1.0 - gone;
  const double of_deviation = 2.0 / (spans * spans) * (spans - 2.0 * gone + 0.5 * (1.0 - kept * kept));
  return {.kept = kept,
          .mean = gone / spans,
          .of_mean = noise.deviation * of_deviation + noise.white / samples,
          .at_end = noise.deviation * (1.0 - kept * kept),
          .crossed = noise.deviation * gone * gone / spans};
}

ActuatorNoiseMeans actuator_noise_means(const ActuatorNoise& noise, std::span<const double> edges,
                                        std::span<const double> samples) {
  const auto count = std::ssize(samples);
  ActuatorNoiseMeans means{Eigen::VectorXd::Zero(count + 1), Eigen::MatrixXd::Zero(count + 1, count + 1)};
  auto& c = means.covariance;
  means.by_start[count] = 1.0;  // the last row is the deviation now
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const auto [kept, mean, of_mean, at_end, crossed] =
        actuator_noise_interval(noise, edges[at + 1] - edges[at], samples[at]);
    means.by_start[k] = mean * means.by_start[count];
    c.row(k) = mean * c.row(count);
    c(k, k) = mean * mean * c(count, count) + of_mean;
    c(k, count) = kept * mean * c(count, count) + crossed;
    c.col(k).head(k) = c.row(k).head(k).transpose();
    c.row(count).head(k) *= kept;
    c(count, k) = c(k, count);
    c(count, count) = kept * kept * c(count, count) + at_end;
    c.col(count).head(k) = c.row(count).head(k).transpose();
    means.by_start[count] *= kept;
  }
  return means;
}

}  // namespace slipwise
