// SPDX-License-Identifier: Apache-2.0
// First-order lag under a held input: the exact step, its mean, and exact sensitivities (derivations/actuator.md;
// thesis 8.1).
#pragma once

#include <algorithm>
#include <cmath>

#include "slipwise/linear/plain_value.hpp"
#include "slipwise/linear/same_stamp.hpp"

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
  LagStep by_input;          ///< by the held input
  LagStep by_time_constant;  ///< by the time constant
};

/// How a gap between output and input closes over a step, the same for every output with this time constant.
struct LagDecay {
  double time_constant;  ///< [s]; zero follows the input at once
  double duration;       ///< [s]
  double gone = 1.0;     ///< the fraction of the gap that has closed, 1 - a of derivations/actuator.md
  double left = 0.0;     ///< the fraction that is left, a
  double by_rate = 0.0;  ///< a * duration / time_constant

  LagDecay(double time_constant_s, double duration_s) : time_constant(time_constant_s), duration(duration_s) {
    if (time_constant > 0.0) {
      const double ratio = duration / time_constant;
      gone = -std::expm1(-ratio);
      left = 1.0 - gone;
      by_rate = left == 0.0 ? 0.0 : left * ratio;  // the ratio may be infinite
    }
  }
};

/// Into how many equal parts a stretch is cut, so that a lagging speed is averaged over no more than `longest`. A
/// stretch that is longer than whole parts by no more than rounding gets no other part.
inline int lag_parts(double duration, double longest) {
  return std::max(1, static_cast<int>(std::ceil((duration - kSameStamp) / longest)));
}

/// V' = (input - V) / time_constant, with V = `output` at the start.
inline LagStepLinearization linearize_lag_step(double output, double input, const LagDecay& decay) {
  const double gap = output - input;
  const double lag = decay.time_constant;
  LagStepLinearization step{.value = {input + gap * decay.left, input * decay.duration + gap * lag * decay.gone},
                            .by_duration = {0.0, input + gap * decay.left},
                            .by_output = {decay.left, lag * decay.gone},
                            .by_input = {decay.gone, decay.duration - lag * decay.gone},
                            .by_time_constant = {0.0, 0.0}};
  if (decay.left > 0.0) {
    step.by_duration.output = -gap * decay.left / lag;
    step.by_time_constant.output = gap * decay.by_rate / lag;
  }
  if (lag > 0.0) {
    step.by_time_constant.integral = gap * (decay.gone - decay.by_rate);
  }
  return step;
}

inline LagStepLinearization linearize_lag_step(double output, double input, double time_constant, double duration) {
  return linearize_lag_step(output, input, LagDecay(time_constant, duration));
}

/// The output alone, without the way.
inline double lag_output(double output, double input, double time_constant, double duration) {
  return time_constant > 0.0 ? input + (output - input) * std::exp(-duration / time_constant) : input;
}
/// The same of numbers with derivatives.
template <typename T>
T lag_output(const T& output, const T& input, const T& time_constant, const T& duration) {
  return value_of(time_constant) > 0.0 ? output + (output - input) * expm1(-duration / time_constant) : input;
}

}  // namespace slipwise
