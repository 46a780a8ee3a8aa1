// SPDX-License-Identifier: Apache-2.0
// One actuator axis from step to step: a fast and a slow first-order mode side by side behind a gain, with derivatives
// by whatever its inputs, its durations and its own parameters move with (derivations/actuator.md).
#pragma once

#include <Eigen/Core>

#include "slipwise/actuator/axis_response.hpp"
#include "slipwise/actuator/first_order_lag.hpp"
#include "slipwise/actuator/slow_mode.hpp"

namespace slipwise {

/// A value with its derivatives by N parameters; by none, the value alone.
template <int N>
struct Sensitive {
  double value = 0.0;
  Eigen::Matrix<double, 1, N> derivative = Eigen::Matrix<double, 1, N>::Zero();
};

template <int N>
double value_of(const Sensitive<N>& number) {
  return number.value;
}

template <int N>
Sensitive<N> operator+(const Sensitive<N>& a, const Sensitive<N>& b) {
  return {a.value + b.value, a.derivative + b.derivative};
}

template <int N>
Sensitive<N> operator-(double a, const Sensitive<N>& b) {
  return {a - b.value, -b.derivative};
}

/// Where an axis's parameters stand among the N; kNotAmong where nothing is differentiated by one.
inline constexpr Eigen::Index kNotAmong = -1;
struct AxisPlaces {
  Eigen::Index time_constant = kNotAmong, delay = kNotAmong, gain = kNotAmong, slow_fraction = kNotAmong,
               slow_time_constant = kNotAmong;
};

/// How the gaps of an axis's two modes close over a step.
struct AxisDecay {
  LagDecay fast, slow;

  AxisDecay(const AxisResponse& response, double duration)
      : fast(response.time_constant, duration), slow(response.slow_time_constant, duration) {}
};

/// The axis under an input that is held until the next one.
template <int N>
class AxisStepper {
 public:
  using Value = Sensitive<N>;
  using Row = Eigen::Matrix<double, 1, N>;

  explicit AxisStepper(const AxisResponse& response, const AxisPlaces& places = {})
      : response_(response), places_(places) {}

  const AxisResponse& response() const { return response_; }
  const Value& fast() const { return fast_; }
  const Value& slow() const { return slow_; }
  Value whole() const { return fast_ + slow_; }

  /// What its modes hold.
  void start(const Value& fast, const Value& slow) {
    fast_ = fast;
    slow_ = slow;
    moves_ = fast.value != 0.0 || slow.value != 0.0 || !fast.derivative.isZero(0.0) || !slow.derivative.isZero(0.0);
  }

  /// An input that was held for long.
  void settle(double input) {
    moves_ = false;
    hold(input);
    fast_ = towards_fast_;
    slow_ = towards_slow_;
  }

  /// An input that moves with no parameter.
  void hold(double input) {
    towards_fast_ = part(input, false);
    if (response_.has_slow_mode()) {
      towards_slow_ = part(input, true);
    }
    moves_ = moves_ || input != 0.0;
  }

  /// An input that moves with some of the N, which are none of the axis's own.
  void hold(const Value& input) {
    const double fast = response_.fast_fraction(), slow = response_.fraction() * response_.gain;
    towards_fast_ = {fast * input.value, fast * input.derivative};
    towards_slow_ = {slow * input.value, slow * input.derivative};
    moves_ = moves_ || input.value != 0.0 || !input.derivative.isZero(0.0);
  }

  /// The whole was measured while the held input acts. What the inputs leave unexplained lasts as the slow mode does;
  /// unless it `lasts`, only so much of it that inputs to come do not carry the whole beyond themselves and it.
  void measure(double value, bool lasts) {
    moves_ = moves_ || value != 0.0;
    if (!response_.has_slow_mode()) {
      fast_ = {.value = value};
      return;
    }
    const Value bound = lasts ? value - towards_fast_ : kept_slow(value);
    slow_ = slow_mode<Value>({.left = value - fast_, .modelled = slow_, .settled = towards_slow_, .bound = bound});
    fast_ = value - slow_;
  }

  /// It was measured before any input acts: what it does is held.
  void keep(double value) {
    moves_ = value != 0.0;
    slow_ = kept_slow(value);
    fast_ = value - slow_;
    towards_fast_ = fast_;
    towards_slow_ = slow_;
  }

  /// Advances over a step; returns the integral [m or rad].
  double advance_value(const AxisDecay& decay) {
    if (!moves_) {
      return 0.0;
    }
    double integral = advance_value(fast_, towards_fast_, decay.fast);
    if (response_.has_slow_mode()) {
      integral += advance_value(slow_, towards_slow_, decay.slow);
    }
    return integral;
  }

  /// The same with derivatives; the step's duration may move with the parameters too.
  Value advance(const AxisDecay& decay, const Row& duration_derivative) {
    if (!moves_) {
      return {};
    }
    const Value fast = advance(fast_, towards_fast_, decay.fast, places_.time_constant, duration_derivative);
    return response_.has_slow_mode()
               ? fast + advance(slow_, towards_slow_, decay.slow, places_.slow_time_constant, duration_derivative)
               : fast;
  }

  /// Goes on for a while without its integral.
  void follow(const AxisDecay& decay, const Row& duration_derivative) {
    if (!moves_) {
      return;
    }
    follow(fast_, towards_fast_, linearize_lag_step(fast_.value, towards_fast_.value, decay.fast),
           places_.time_constant, duration_derivative);
    if (response_.has_slow_mode()) {
      follow(slow_, towards_slow_, linearize_lag_step(slow_.value, towards_slow_.value, decay.slow),
             places_.slow_time_constant, duration_derivative);
    }
  }

  /// Without lag, the derivative of a step's integral by the gain.
  double by_gain(double duration) const { return towards_fast_.derivative[places_.gain] * duration; }

 private:
  /// Of an input, what one of the modes goes towards: its fraction of gain * input.
  Value part(double input, bool slow) const {
    const double fraction = slow ? response_.fraction() : 1.0 - response_.fraction();
    Value part{.value = fraction * response_.gain * input};
    if constexpr (N > 0) {
      if (places_.gain != kNotAmong) {
        part.derivative[places_.gain] = fraction * input;
      }
      if (places_.slow_fraction != kNotAmong && response_.has_slow_mode()) {
        part.derivative[places_.slow_fraction] = (slow ? 1.0 : -1.0) * response_.gain * input;
      }
    }
    return part;
  }

  /// Of a speed that is kept for long, what the slow mode holds.
  Value kept_slow(double speed) const {
    Value share{.value = response_.fraction() * speed};
    if constexpr (N > 0) {
      if (places_.slow_fraction != kNotAmong && response_.has_slow_mode()) {
        share.derivative[places_.slow_fraction] = speed;
      }
    }
    return share;
  }

  static double advance_value(Value& mode, const Value& towards, const LagDecay& decay) {
    const LagStep step = linearize_lag_step(mode.value, towards.value, decay).value;
    mode.value = step.output;
    return step.integral;
  }

  static void follow(Value& mode, const Value& towards, const LagStepLinearization& step, Eigen::Index time_constant,
                     const Row& duration_derivative) {
    if constexpr (N > 0) {
      mode.derivative = (step.by_duration.output * duration_derivative + step.by_output.output * mode.derivative +
                         step.by_input.output * towards.derivative)
                            .eval();
      if (time_constant != kNotAmong) {
        mode.derivative[time_constant] += step.by_time_constant.output;
      }
    }
    mode.value = step.value.output;
  }

  static Value advance(Value& mode, const Value& towards, const LagDecay& decay, Eigen::Index time_constant,
                       const Row& duration_derivative) {
    const auto step = linearize_lag_step(mode.value, towards.value, decay);
    Value integral{.value = step.value.integral};
    if constexpr (N > 0) {
      integral.derivative = step.by_duration.integral * duration_derivative +
                            step.by_output.integral * mode.derivative + step.by_input.integral * towards.derivative;
      if (time_constant != kNotAmong) {
        integral.derivative[time_constant] += step.by_time_constant.integral;
      }
    }
    follow(mode, towards, step, time_constant, duration_derivative);
    return integral;
  }

  AxisResponse response_;
  AxisPlaces places_;
  Value fast_, slow_, towards_fast_, towards_slow_;
  /// Most robots never drive sideways. What has not moved, and is not commanded to, has no derivatives either.
  bool moves_ = false;
};

}  // namespace slipwise
