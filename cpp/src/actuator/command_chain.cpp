// SPDX-License-Identifier: Apache-2.0
// The walk over delayed input changes that turns inputs into drive steps.
#include "slipwise/actuator/command_chain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slipwise/actuator/first_order_lag.hpp"

namespace slipwise {
namespace {

using Row = Eigen::Matrix<double, 1, kChainParameters>;
constexpr Eigen::Index kLagV = 0, kLagOmega = 1, kDelayV = 2, kDelayOmega = 3, kOffset = 4;
constexpr Eigen::Index kFixed = -1;
constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kSettledLags = 8.0;  // after this many time constants the start of a lag is forgotten (e^-8)

/// A moment that moves with one of the chain's parameters: later with a delay, earlier with the clock offset.
struct Moment {
  double t;
  Eigen::Index parameter;

  Row slope() const {
    Row row = Row::Zero();
    if (parameter != kFixed) {
      row[parameter] = parameter == kOffset ? -1.0 : 1.0;
    }
    return row;
  }
};

/// A lag's output with its total derivative.
struct LagState {
  double output = 0.0;
  Row slope = Row::Zero();
};

/// The samples of one channel as the drive sees them: delayed.
class DelayedCursor {
 public:
  DelayedCursor(const InputTrack& inputs, double delay, Eigen::Index delay_index, double start, double known_until)
      : inputs_(inputs),
        delay_(delay),
        index_(delay_index),
        next_(inputs.count_until(start - delay)),
        end_(std::max(next_, inputs.count_until(known_until))) {}

  BodyTwist held() const { return next_ == 0 ? BodyTwist{} : inputs_.sample(next_ - 1); }
  double next_change() const { return next_ < end_ ? inputs_.time(next_) + delay_ : kNever; }
  Moment change_moment() const { return {next_change(), index_}; }
  void advance() { ++next_; }
  std::size_t changes_left() const { return end_ - next_; }

 private:
  const InputTrack& inputs_;
  double delay_;
  Eigen::Index index_;
  std::size_t next_;
  std::size_t end_;
};

/// Advances one lag over a step; returns the integral.
double advance(LagState& state, double input, const LagDecay& decay) {
  const LagStep step = linearize_lag_step(state.output, input, decay).value;
  state.output = step.output;
  return step.integral;
}

/// An integral with its slope.
struct Integral {
  double value;
  Row slope;
};

/// The same for a step whose duration moves with the parameters.
Integral advance(LagState& state, double input, const LagDecay& decay, Eigen::Index lag_index,
                 const Row& duration_slope) {
  const auto step = linearize_lag_step(state.output, input, decay);
  Integral integral{step.value.integral,
                    step.by_duration.integral * duration_slope + step.by_output.integral * state.slope};
  integral.slope[lag_index] += step.by_time_constant.integral;
  state.slope = step.by_duration.output * duration_slope + step.by_output.output * state.slope;
  state.slope[lag_index] += step.by_time_constant.output;
  state.output = step.value.output;
  return integral;
}

/// Walks over the delayed input changes of a window, with or without slopes.
class ChainWalk {
 public:
  ChainWalk(const InputTrack& inputs, const CommandChain& chain, const DriveWindow& window, bool with_slopes)
      : chain_(chain),
        longest_step_(window.longest_step),
        with_slopes_(with_slopes),
        start_(moment_of(window.start)),
        end_(moment_of(window.end)),
        warm_up_(window.initial ? 0.0 : kSettledLags * std::max(chain.lag_v, chain.lag_omega)),
        cursor_v_(inputs, chain.delay_v, kDelayV, start_.t - warm_up_, window.end),
        cursor_omega_(inputs, chain.delay_omega, kDelayOmega, start_.t - warm_up_, window.end) {
    const BodyTwist begin =
        window.initial.value_or(BodyTwist{cursor_v_.held().v, cursor_v_.held().vy, cursor_omega_.held().omega});
    v_.output = begin.v;
    vy_.output = begin.vy;
    omega_.output = begin.omega;
  }

  DriveSteps run() {
    if (warm_up_ > 0.0) {
      cover({start_.t - warm_up_, kFixed}, start_, nullptr);
    }
    DriveSteps result;
    const std::size_t steps = cursor_v_.changes_left() + cursor_omega_.changes_left() + 2;
    result.steps.reserve(steps);
    result.jacobians.reserve(with_slopes_ ? steps : 0);
    cover(start_, end_, &result);
    return result;
  }

 private:
  Moment moment_of(double stamp) const { return {stamp - chain_.clock_offset, kOffset}; }

  /// Steps from `now` to `until`; they are recorded where there is an `out`.
  void cover(Moment now, const Moment& until, DriveSteps* out) {
    while (now.t < until.t) {
      const double change = std::min(cursor_v_.next_change(), cursor_omega_.next_change());
      Moment next = until;
      if (change < until.t) {
        next = cursor_v_.next_change() <= change ? cursor_v_.change_moment() : cursor_omega_.change_moment();
      }
      subdivide(now, next, out);
      advance_cursors(next.t);
      now = next;
    }
  }

  /// Changes of the two channels are taken one at a time, since they move apart with their delays; without delays,
  /// together.
  void advance_cursors(double t) {
    const bool v_changes = cursor_v_.next_change() <= t;
    const bool omega_changes = cursor_omega_.next_change() <= t;
    const bool together = chain_.delay_v == 0.0 && chain_.delay_omega == 0.0;
    if (v_changes) {
      cursor_v_.advance();
    }
    if (omega_changes && (together || !v_changes)) {
      cursor_omega_.advance();
    }
  }

  void subdivide(const Moment& from, const Moment& to, DriveSteps* out) {
    const bool lagging = chain_.lag_v > 0.0 || chain_.lag_omega > 0.0;
    const int parts = lagging ? std::max(1, static_cast<int>(std::ceil((to.t - from.t) / longest_step_))) : 1;
    const double duration = (to.t - from.t) / parts;
    const LagDecay decay_v(chain_.lag_v, duration);
    const LagDecay decay_omega(chain_.lag_omega, duration);
    // Without lag, only steps whose duration moves have slopes.
    if (with_slopes_ && (lagging || from.parameter != to.parameter)) {
      const Row slope = (to.slope() - from.slope()) * (1.0 / parts);
      for (int i = 0; i < parts; ++i) {
        DriveStepJacobian jacobian;
        const DriveStep step = linearize_step(decay_v, decay_omega, slope, jacobian);
        record(step, jacobian, out);
      }
      return;
    }
    const DriveStepJacobian no_slopes = DriveStepJacobian::Zero();
    for (int i = 0; i < parts; ++i) {
      record(next_step(decay_v, decay_omega), no_slopes, out);
    }
  }

  void record(const DriveStep& step, const DriveStepJacobian& jacobian, DriveSteps* out) const {
    if (out != nullptr) {
      out->steps.push_back(step);
      if (with_slopes_) {
        out->jacobians.push_back(jacobian);
      }
    }
  }

  DriveStep next_step(const LagDecay& decay_v, const LagDecay& decay_omega) {
    const BodyTwist linear = cursor_v_.held();
    return {decay_v.duration, advance(v_, linear.v, decay_v), advance(vy_, linear.vy, decay_v),
            advance(omega_, cursor_omega_.held().omega, decay_omega)};
  }

  DriveStep linearize_step(const LagDecay& decay_v, const LagDecay& decay_omega, const Row& duration_slope,
                           DriveStepJacobian& jacobian) {
    const BodyTwist linear = cursor_v_.held();
    const Integral forward = advance(v_, linear.v, decay_v, kLagV, duration_slope);
    const Integral left = advance(vy_, linear.vy, decay_v, kLagV, duration_slope);
    const Integral turn = advance(omega_, cursor_omega_.held().omega, decay_omega, kLagOmega, duration_slope);
    jacobian << duration_slope, forward.slope, left.slope, turn.slope;
    return {decay_v.duration, forward.value, left.value, turn.value};
  }

  const CommandChain& chain_;
  double longest_step_;
  bool with_slopes_;
  Moment start_;
  Moment end_;
  double warm_up_;
  DelayedCursor cursor_v_;
  DelayedCursor cursor_omega_;
  LagState v_, vy_, omega_;
};

}  // namespace

DriveSteps drive_steps(const InputTrack& inputs, const CommandChain& chain, const DriveWindow& window) {
  return ChainWalk(inputs, chain, window, false).run();
}

DriveSteps linearize_drive_steps(const InputTrack& inputs, const CommandChain& chain, const DriveWindow& window) {
  return ChainWalk(inputs, chain, window, true).run();
}

}  // namespace slipwise
