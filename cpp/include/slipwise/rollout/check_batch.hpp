// SPDX-License-Identifier: Apache-2.0
// What is wrong with a batch of rollouts, in words.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "slipwise/rollout/rollout_batch.hpp"

namespace slipwise {

inline bool is_finite(const DriveCommand& command) {
  return std::isfinite(command.v) && std::isfinite(command.omega) && std::isfinite(command.vy);
}

inline bool is_finite(const RolloutStart& start) { return start.pose.vector().allFinite() && is_finite(start.drive); }

/// Nothing of a sideways speed is dropped, and none is missing.
template <typename Scalar>
void check_axes(const RolloutProgram& program, const RolloutBatch<Scalar>& batch) {
  const bool given = batch.commands.vy != nullptr;
  if (program.sideways() && !given) {
    throw std::invalid_argument(
        "the model drives sideways: its commands are (v, vy, omega), and no vy is given; give zeros where there is "
        "none");
  }
  const auto drives = [](const DriveCommand& command) { return command.vy != 0.0; };
  if (!program.sideways() &&
      (given || std::ranges::any_of(batch.past, drives) ||
       std::ranges::any_of(batch.starts, [&](const auto& start) { return drives(start.drive); }))) {
    throw std::invalid_argument(
        "the model drives by (v, omega), and a sideways speed is given; leave it out, or compile the model for it");
  }
}

template <typename Scalar>
void check_batch(const RolloutBatch<Scalar>& batch) {
  if (batch.rollouts == 0 || batch.periods == 0) {
    throw std::invalid_argument("the batch is empty: " + std::to_string(batch.rollouts) + " rollouts of " +
                                std::to_string(batch.periods) + " periods; give at least one command");
  }
  if (batch.commands.v == nullptr || batch.commands.omega == nullptr) {
    throw std::invalid_argument("the batch has no commands; point to speeds and yaw rates");
  }
  if (batch.starts.size() != 1 && batch.starts.size() != batch.rollouts) {
    throw std::invalid_argument("there are " + std::to_string(batch.starts.size()) + " starts for " +
                                std::to_string(batch.rollouts) + " rollouts; give one, or one each");
  }
  if (batch.past.size() % batch.starts.size() != 0) {
    throw std::invalid_argument(std::to_string(batch.past.size()) + " past commands cannot be shared out to " +
                                std::to_string(batch.starts.size()) + " starts; give the same number for each");
  }
  for (std::size_t i = 0; i < batch.starts.size(); ++i) {
    if (!is_finite(batch.starts[i])) {
      throw std::invalid_argument("start " + std::to_string(i) + " is not finite");
    }
  }
  for (std::size_t i = 0; i < batch.past.size(); ++i) {
    if (!is_finite(batch.past[i])) {
      throw std::invalid_argument("past command " + std::to_string(i) + " is not finite");
    }
  }
}

/// Commands that no pose depends on, since they are still in the delay at the end, must be finite as well.
template <typename Scalar>
void check_commands(const RolloutBatch<Scalar>& batch, std::size_t first_period) {
  const CommandView<Scalar>& commands = batch.commands;
  for (std::size_t n = 0; n < batch.rollouts; ++n) {
    for (std::size_t k = first_period; k < batch.periods; ++k) {
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(n) * commands.rollout_stride +
                                static_cast<std::ptrdiff_t>(k) * commands.period_stride;
      if (!std::isfinite(commands.v[at]) || !std::isfinite(commands.omega[at]) ||
          (commands.vy != nullptr && !std::isfinite(commands.vy[at]))) {
        throw std::invalid_argument("the command of rollout " + std::to_string(n) + " over period " +
                                    std::to_string(k) + " is not finite");
      }
    }
  }
}

}  // namespace slipwise
