// SPDX-License-Identifier: Apache-2.0
// Many command sequences driven through one model at once: exact steps, on one core or several.
#pragma once

#include <cstddef>
#include <span>

#include "slipwise/lie/se2.hpp"
#include "slipwise/rollout/costmap.hpp"
#include "slipwise/rollout/drive_command.hpp"
#include "slipwise/rollout/instruction_level.hpp"
#include "slipwise/rollout/rollout_program.hpp"

namespace slipwise {

/// The command of rollout n over period k stands at [n * rollout_stride + k * period_stride] of `v` and `omega`.
/// Fastest is rollout_stride = 1: the commands of one period side by side.
template <typename Scalar>
struct CommandView {
  const Scalar* v;                ///< [m/s]
  const Scalar* omega;            ///< [rad/s]
  std::ptrdiff_t rollout_stride;  ///< in numbers, not bytes
  std::ptrdiff_t period_stride;
  const Scalar* vy = nullptr;  ///< [m/s]; of programs that drive sideways, and of no others
};

/// What the robot does where a rollout starts.
struct RolloutStart {
  Pose2 pose;          ///< in the frame that the results are wanted in
  DriveCommand drive;  ///< what the drive does now; it matters where there is lag
};

template <typename Scalar>
struct RolloutBatch {
  std::size_t rollouts;
  std::size_t periods;
  CommandView<Scalar> commands;
  std::span<const RolloutStart> starts;  ///< one for all rollouts, or one each
  /// Commands sent before the start, one period apart, the oldest first, the same number for every start. Those that
  /// are still in the delay act first. What is older than these equals the oldest; without any, it is the start's
  /// drive.
  std::span<const DriveCommand> past = {};
};

/// What is wanted; null is not. Rows of periods hold what is true at each period's end, rollouts side by side.
template <typename Scalar>
struct RolloutOutputs {
  Scalar* x = nullptr;          ///< [periods * rollouts] [m]
  Scalar* y = nullptr;          ///< [periods * rollouts] [m]
  Scalar* theta = nullptr;      ///< [periods * rollouts] [rad], not wrapped
  Scalar* end_x = nullptr;      ///< [rollouts]
  Scalar* end_y = nullptr;      ///< [rollouts]
  Scalar* end_theta = nullptr;  ///< [rollouts]
  const Costmap* map = nullptr;
  Scalar* cost_sum = nullptr;      ///< [rollouts], sum of the map's values at the periods' ends
  Scalar* cost_highest = nullptr;  ///< [rollouts], the highest of them
  Scalar* cost_lowest = nullptr;   ///< [rollouts], the lowest: the clearance, where the map holds distances
};

class Gpu;

struct RolloutOptions {
  unsigned threads = 1;  ///< the results are the same bytes for any number
  InstructionLevel level = best_instruction_level();
  Gpu* gpu = nullptr;  ///< null: on the processor
};

/// Drives all commands and fills the outputs. Allocates nothing with one thread and without limits. Float and double.
/// With a GPU, commands, outputs and the map's cells may lie in its memory as well as in the processor's; what lies in
/// the processor's is copied. All work of the GPU's default stream is done first.
/// \throws std::invalid_argument when the batch is empty, sizes do not fit each other, a command or start is not
/// finite, the processor lacks the instruction level, or the program is too long for the GPU.
/// \throws std::runtime_error when the GPU fails.
template <typename Scalar>
void rollout_batch(const RolloutProgram& program, const RolloutBatch<Scalar>& batch,
                   const RolloutOutputs<Scalar>& outputs, const RolloutOptions& options = {});

}  // namespace slipwise
