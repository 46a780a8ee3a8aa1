// SPDX-License-Identifier: Apache-2.0
// What of an axis's measured speed is not its actuator: white noise of the samples, and a correlated deviation
// (derivations/actuator.md).
#pragma once

#include <Eigen/Core>
#include <span>

namespace slipwise {

/// Shape of that noise. The deviation is a Gauss-Markov process (Ornstein and Uhlenbeck).
struct ActuatorNoise {
  double white = 1.0;          ///< variance of one sample
  double deviation = 0.0;      ///< variance of the deviation
  double time_constant = 1.0;  ///< of the deviation [s]
};

/// One interval of it.
struct ActuatorNoiseInterval {
  double kept;     ///< of the deviation, from its start to its end
  double mean;     ///< of the deviation at its start, in the mean over it
  double of_mean;  ///< variance of what is new in that mean, white noise included
  double at_end;   ///< variance of what is new in the deviation at its end
  double crossed;  ///< covariance of both
};
ActuatorNoiseInterval actuator_noise_interval(const ActuatorNoise& noise, double duration, double samples);

/// The means over some intervals, and after them the deviation at the end: how they follow the deviation at the start,
/// and their covariance, were that known.
struct ActuatorNoiseMeans {
  Eigen::VectorXd by_start;    ///< [K + 1]
  Eigen::MatrixXd covariance;  ///< [K + 1, K + 1]
};

/// `edges` [K + 1, s] are those of the intervals, of which each holds so many `samples` [K].
ActuatorNoiseMeans actuator_noise_means(const ActuatorNoise& noise, std::span<const double> edges,
                                        std::span<const double> samples);

}  // namespace slipwise
