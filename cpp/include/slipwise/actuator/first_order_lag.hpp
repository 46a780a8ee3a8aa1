// SPDX-License-Identifier: Apache-2.0
// First-order lag under a held input: the exact step, its mean, and exact sensitivities (method.md, section 4; thesis 8.1).
#pragma once

#include <cmath>

namespace slipwise {

/// The lag's output after a step and its integral over the step.
struct LagStep {
  double output;    ///< V at the step's end
  double integral;  ///< integral of V over the step: distance, or angle
};

/// Partial derivatives of a lag step.
struct LagStepLinearization {
  LagStep value;
  LagStep by_duration;       ///< by the step's duration
  LagStep by_output;         ///< by V at the step's start
  LagStep by_time_constant;  ///< by the time constant
};

/// V' = (input - V) / time_constant. A time constant of zero follows the input at once.
inline LagStepLinearization linearize_lag_step(double output, double input, double time_constant, double duration) {
  if (time_constant <= 0.0) {
    return {.value = {input, input * duration}, .by_duration = {0.0, input}, .by_output = {0.0, 0.0}, .by_time_constant = {}};
  }
  const double ratio = duration / time_constant;
  const double decay = std::exp(-ratio);
  const double gone = -std::expm1(-ratio);
  const double gap = output - input;
  return {.value = {input + gap * decay, input * duration + gap * time_constant * gone},
          .by_duration = {-gap * decay / time_constant, input + gap * decay},
          .by_output = {decay, time_constant * gone},
          .by_time_constant = {gap * decay * ratio / time_constant, gap * (gone - decay * ratio)}};
}

inline LagStep lag_step(double output, double input, double time_constant, double duration) {
  return linearize_lag_step(output, input, time_constant, duration).value;
}

}  // namespace slipwise
