// SPDX-License-Identifier: Apache-2.0
// Shapes of what Python hands over, checked where the core takes them as given: a wrong one throws, it never crashes.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "slipwise/actuator/input_history.hpp"
#include "slipwise/filter/estimate.hpp"
#include "slipwise/filter/motion_posterior.hpp"
#include "slipwise/motion/motion_model.hpp"

namespace slipwise::bindings {

/// A vector of one number per parameter.
inline void check_size(const Eigen::VectorXd& vector, Eigen::Index expected, const char* what) {
  if (vector.size() != expected) {
    throw std::invalid_argument(std::string(what) + " needs " + std::to_string(expected) + " numbers, got " +
                                std::to_string(vector.size()));
  }
}

/// A covariance of as many parameters as expected.
inline void check_square(const Eigen::MatrixXd& matrix, Eigen::Index expected, const char* what) {
  if (matrix.rows() != expected || matrix.cols() != expected) {
    throw std::invalid_argument(std::string(what) + " needs " + std::to_string(expected) + " rows and columns, got " +
                                std::to_string(matrix.rows()) + " by " + std::to_string(matrix.cols()));
  }
}

/// Rows of as many numbers as expected.
inline void check_columns(const Eigen::MatrixXd& matrix, Eigen::Index expected, const char* what) {
  if (matrix.cols() != expected) {
    throw std::invalid_argument(std::string(what) + " needs rows of " + std::to_string(expected) + " numbers, got " +
                                std::to_string(matrix.cols()));
  }
}

/// A list of inputs, as long as the lists beside it, in which none is missing.
inline void check_inputs(const std::vector<const InputHistory*>& inputs, std::size_t segments, std::size_t noise) {
  if (inputs.size() != segments || noise != segments) {
    throw std::invalid_argument("each segment needs inputs and noise, got " + std::to_string(segments) + " segments, " +
                                std::to_string(inputs.size()) + " inputs and " + std::to_string(noise) + " noises");
  }
  if (std::ranges::find(inputs, nullptr) != inputs.end()) {
    throw std::invalid_argument("each segment needs inputs, got None");
  }
}

/// A way to explain motion by its number.
inline Structure structure_of(std::size_t number) {
  if (number >= kStructures) {
    throw std::invalid_argument("structures are numbered from 0 to " + std::to_string(kStructures - 1) + ", got " +
                                std::to_string(number));
  }
  return static_cast<Structure>(number);
}

/// An estimate of all parameters of a model.
inline void check_estimate(const MotionModel& model, const Estimate& estimate) {
  check_size(estimate.mean, model.size(), "the estimate of a model");
  check_square(estimate.covariance, model.size(), "the covariance of a model");
}

}  // namespace slipwise::bindings
