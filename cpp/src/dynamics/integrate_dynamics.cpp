// SPDX-License-Identifier: Apache-2.0
// Runge-Kutta of a state, and of its derivatives along it.
#include "slipwise/dynamics/integrate_dynamics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr std::array<double, 4> kAt{0.0, 0.5, 0.5, 1.0};  // of the step, where the method looks
constexpr std::array<double, 4> kShare{1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};

/// Calls `step(seconds, input)` for pieces that end where an input changes.
template <class Step>
void in_steps(const HeldInputs& inputs, const DynamicsSpan& span, const Step& step) {
  double t = span.start;
  while (later(span.end, t)) {
    const Eigen::VectorXd& input = inputs.at(t);
    const double until = inputs.until(t, span.end);
    const double pieces = std::max(1.0, std::ceil((until - t - kSameStamp) / span.longest_step));
    for (long left = std::lround(pieces); left > 0; --left) {
      step((until - t) / pieces, input);
    }
    t = until;
  }
}

void need_finite(const Eigen::VectorXd& state) {
  if (!state.allFinite()) {
    throw std::runtime_error(
        "the state is not finite any more; give start parameters or a start state closer to the truth, or smaller "
        "steps");
  }
}

Eigen::VectorXd stepped(const DynamicsModel& model, const Eigen::VectorXd& input, double h,
                        const Eigen::VectorXd& state, const Eigen::VectorXd& parameters) {
  Eigen::VectorXd sum = state;
  Eigen::VectorXd rate = Eigen::VectorXd::Zero(state.size());
  for (std::size_t i = 0; i < kAt.size(); ++i) {
    rate = model.derivative(state + kAt[i] * h * rate, input, parameters);
    sum += kShare[i] * h * rate;
  }
  return sum;
}

}  // namespace

Eigen::VectorXd dynamics_state(const DynamicsModel& model, const HeldInputs& inputs, const DynamicsSpan& span,
                               const Eigen::VectorXd& state, const Eigen::VectorXd& parameters) {
  Eigen::VectorXd now = state;
  in_steps(inputs, span,
           [&](double h, const Eigen::VectorXd& input) { now = stepped(model, input, h, now, parameters); });
  need_finite(now);
  return now;
}

DynamicsEnd nothing_passed(const Eigen::VectorXd& state, Eigen::Index parameters) {
  const Eigen::Index n = state.size();
  return {
      .state = state, .by_start = Eigen::MatrixXd::Identity(n, n + parameters), .noise = Eigen::MatrixXd::Zero(n, n)};
}

DynamicsEnd integrate_dynamics(const DynamicsModel& model, const HeldInputs& inputs, const DynamicsSpan& span,
                               const Eigen::VectorXd& state, const Eigen::VectorXd& parameters) {
  return integrate_dynamics(model, inputs, span, nothing_passed(state, parameters.size()), parameters);
}

DynamicsEnd integrate_dynamics(const DynamicsModel& model, const HeldInputs& inputs, const DynamicsSpan& span,
                               DynamicsEnd now, const Eigen::VectorXd& parameters) {
  const Eigen::Index n = now.state.size();
  const Eigen::Index all = n + parameters.size();
  in_steps(inputs, span, [&](double h, const Eigen::VectorXd& input) {
    Eigen::VectorXd rate = Eigen::VectorXd::Zero(n), sum = now.state;
    Eigen::MatrixXd by_rate = Eigen::MatrixXd::Zero(n, all);
    const Eigen::MatrixXd start = Eigen::MatrixXd::Identity(n, all);  // of this step
    Eigen::MatrixXd by = start;
    for (std::size_t i = 0; i < kAt.size(); ++i) {
      const Eigen::VectorXd at = now.state + kAt[i] * h * rate;
      const DynamicsJacobians f = model.jacobians(at, input, parameters);
      rate = model.derivative(at, input, parameters);
      by_rate = (f.by_state * (start + kAt[i] * h * by_rate)).eval();
      by_rate.rightCols(parameters.size()) += f.by_parameter;
      sum += kShare[i] * h * rate;
      by += kShare[i] * h * by_rate;
    }
    need_finite(sum);
    const auto over = by.leftCols(n);
    const Eigen::MatrixXd half = (0.5 * h * span.psd).asDiagonal();  // what is added in half a step, by the trapezium
    now.state = sum;
    now.noise = (over * (now.noise + half) * over.transpose() + half).eval();
    now.by_start = (over * now.by_start).eval();
    now.by_start.rightCols(parameters.size()) += by.rightCols(parameters.size());
  });
  return now;
}

}  // namespace slipwise
