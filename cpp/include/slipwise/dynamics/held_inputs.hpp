// SPDX-License-Identifier: Apache-2.0
// Inputs of a user's dynamics, each held until the next.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <utility>

namespace slipwise {

/// In the order of their stamps.
class HeldInputs {
 public:
  /// \throws std::invalid_argument when a number is not finite, the size is another one than before, or the stamp is
  /// not later than the last.
  void push(double t, Eigen::VectorXd input);
  /// Those that were replaced at `t` [s] or before are not asked for any more.
  void forget_before(double t);

  bool empty() const { return inputs_.empty(); }
  /// Stamp of the first [s].
  double first() const { return inputs_.front().first; }
  /// What is held from `t` [s] on. \throws std::invalid_argument before the first.
  const Eigen::VectorXd& at(double t) const;
  /// When what is held at `t` is replaced [s], no later than `end`.
  double until(double t, double end) const;

 private:
  using Inputs = std::deque<std::pair<double, Eigen::VectorXd>>;

  Inputs::const_iterator later_than(double t) const;

  Inputs inputs_;
};

}  // namespace slipwise
