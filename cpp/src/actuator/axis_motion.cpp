// SPDX-License-Identifier: Apache-2.0
// A walk of one axis over delayed input changes and the moments at which it is asked for.
#include "slipwise/actuator/axis_motion.hpp"

#include "slipwise/actuator/axis_stepper.hpp"

namespace slipwise {
namespace {

constexpr AxisPlaces kPlaces{.time_constant = 0, .delay = 1, .gain = 2, .slow_fraction = 3, .slow_time_constant = 4};
constexpr Eigen::Index kFast = 5;
constexpr Eigen::Index kSlow = 6;

/// With derivatives by N parameters: all, or none.
template <int N>
class AxisWalk {
 public:
  using Value = Sensitive<N>;
  using Row = Eigen::Matrix<double, 1, N>;

  AxisWalk(const InputHistory& inputs, const ActuatorAxis& axis, const AxisState& start, double time)
      : inputs_(inputs),
        axis_(axis),
        stepper_(axis.response, kPlaces),
        now_(time),
        next_(inputs.count_until(time - axis.delay)) {
    stepper_.start(starting(start.fast, kFast), starting(start.slow, kSlow));
    hold(next_ == 0 ? 0.0 : inputs_.sample(next_ - 1).*axis_.part);
  }

  /// Goes on to `time`; returns the mean until there.
  Value mean_until(double time) {
    const double begun = now_;
    Value integral;
    walk_until(time, [&](const AxisDecay& decay, const Row& duration_derivative) {
      integral = integral + stepper_.advance(decay, duration_derivative);
    });
    return {integral.value / (time - begun), integral.derivative / (time - begun)};
  }

  /// Goes on to `time`, whatever happens on the way.
  void follow_until(double time) {
    walk_until(time, [&](const AxisDecay& decay, const Row& duration_derivative) {
      stepper_.follow(decay, duration_derivative);
    });
  }

  const AxisStepper<N>& stepper() const { return stepper_; }

 private:
  void hold(double input) {
    held_ = input;
    stepper_.hold(input);
  }

  template <typename Step>
  void walk_until(double time, const Step& step) {
    for (; next_ < inputs_.size() && inputs_.time(next_) + axis_.delay < time; ++next_) {
      if (const double input = inputs_.sample(next_).*axis_.part; input != held_) {
        go_to(inputs_.time(next_) + axis_.delay, 1.0, step);
        hold(input);
      }
    }
    go_to(time, 0.0, step);
  }

  /// A moment that moves with the delay, or stays.
  template <typename Step>
  void go_to(double then, double moves, const Step& step) {
    step(AxisDecay(axis_.response, then - now_), by_delay(moves - moves_));
    now_ = then;
    moves_ = moves;
  }

  /// What a mode holds at the start, which is the parameter at `place`.
  static Value starting(double value, Eigen::Index place) {
    if constexpr (N > 0) {
      return {.value = value, .derivative = Row::Unit(place)};
    } else {
      return {.value = value};
    }
  }

  static Row by_delay(double moves) {
    if constexpr (N > 0) {
      return moves * Row::Unit(kPlaces.delay);
    } else {
      return {};
    }
  }

  const InputHistory& inputs_;
  const ActuatorAxis& axis_;
  AxisStepper<N> stepper_;
  double now_;
  double moves_ = 0.0;
  std::size_t next_;
  double held_ = 0.0;
};

/// Hands `record` each interval's mean, and then both modes at the end.
template <int N, typename Record>
void walk_axis(const InputHistory& inputs, const ActuatorAxis& axis, const AxisState& start,
               std::span<const double> edges, Record record) {
  AxisWalk<N> walk(inputs, axis, start, edges.front());
  const auto intervals = std::ssize(edges) - 1;
  for (std::ptrdiff_t k = 0; k < intervals; ++k) {
    record(k, walk.mean_until(edges[static_cast<std::size_t>(k + 1)]));
  }
  record(intervals, walk.stepper().fast());
  record(intervals + 1, walk.stepper().slow());
}

}  // namespace

AxisState settled_axis(const InputHistory& inputs, const ActuatorAxis& axis, double time) {
  const double input = inputs.at(time - axis.delay).*axis.part;
  return {axis.response.fast_fraction() * input, axis.response.fraction() * axis.response.gain * input};
}

AxisMotion axis_motion(const InputHistory& inputs, const ActuatorAxis& axis, const AxisState& start,
                       std::span<const double> edges) {
  const auto rows = std::ssize(edges) + 1;
  AxisMotion motion{Eigen::VectorXd(rows),
                    Eigen::Matrix<double, Eigen::Dynamic, kAxisParameters>(rows, kAxisParameters)};
  walk_axis<kAxisParameters>(inputs, axis, start, edges, [&motion](Eigen::Index row, const auto& value) {
    motion.value[row] = value.value;
    motion.derivative.row(row) = value.derivative;
  });
  return motion;
}

Eigen::VectorXd axis_values(const InputHistory& inputs, const ActuatorAxis& axis, const AxisState& start,
                            std::span<const double> edges) {
  Eigen::VectorXd values(std::ssize(edges) + 1);
  walk_axis<0>(inputs, axis, start, edges,
               [&values](Eigen::Index row, const auto& value) { values[row] = value.value; });
  return values;
}

void axis_speeds(const InputHistory& inputs, const ActuatorAxis& axis, const AxisState& start,
                 std::span<const double> times, std::span<double> speed) {
  if (times.empty()) {
    return;
  }
  AxisWalk<0> walk(inputs, axis, start, times.front());
  for (std::size_t i = 0; i < times.size(); ++i) {
    walk.follow_until(times[i]);
    speed[i] = walk.stepper().whole().value;
  }
}

}  // namespace slipwise
