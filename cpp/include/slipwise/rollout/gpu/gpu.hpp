// SPDX-License-Identifier: Apache-2.0
// A GPU that drives rollouts: what it is handed, the memory that it keeps, and the copies there and back.
#pragma once

#include <array>
#include <cstddef>
#include <mutex>
#include <span>
#include <vector>

#include "slipwise/rollout/gpu/gpu_device.hpp"
#include "slipwise/rollout/lane_job.hpp"

namespace slipwise {

/// Memory of the GPU that grows when more is asked for, and is given back at the end.
class GpuMemory {
 public:
  GpuMemory() = default;
  ~GpuMemory() { gpu_free(memory_); }
  GpuMemory(const GpuMemory&) = delete;
  GpuMemory& operator=(const GpuMemory&) = delete;
  GpuMemory(GpuMemory&&) = delete;
  GpuMemory& operator=(GpuMemory&&) = delete;

  /// Room for `count` numbers; what was in it may be lost.
  template <typename Number>
  Number* room_for(std::size_t count) {
    return static_cast<Number*>(at_least(count * sizeof(Number)));
  }

 private:
  void* at_least(std::size_t bytes);

  void* memory_ = nullptr;
  std::size_t bytes_ = 0;
};

/// A batch as plain numbers. Commands, outputs and the map's cells lie in the processor's memory or in the GPU's.
template <typename Scalar>
struct GpuBatch {
  LaneJob<Scalar> job;
  std::span<const Scalar> starts;  ///< [kStartRows][1, or rollouts]
  std::span<const DriveCommand> past;
  std::size_t past_count;   ///< of one start
  std::size_t past_stride;  ///< from one rollout's to the next one's
  std::size_t used;         ///< periods from which on no pose depends on a command
};

/// One for any number of batches: the memory that a batch needs is kept for the next. Calls from several threads wait
/// for each other.
class Gpu {
 public:
  /// \throws std::invalid_argument where there is none, with the reason of why_no_gpu.
  Gpu();

  /// \returns what went wrong, as bits.
  /// \throws std::invalid_argument when the program is too long for a GPU's constant memory, or one channel's commands
  /// lie on the GPU and the other's do not. \throws std::runtime_error when the GPU fails, as for want of memory.
  template <typename Scalar>
  unsigned roll(const GpuBatch<Scalar>& batch);

 private:
  template <typename Scalar>
  void bring_commands(LaneJob<Scalar>& job);
  template <typename Scalar>
  const Scalar* bring_rows(const Scalar* commands, const LaneJob<Scalar>& job, GpuMemory& memory);
  template <typename Number>
  const Number* bring(const Number* numbers, std::size_t count, GpuMemory& memory);

  std::mutex one_at_a_time_;
  GpuMemory v_, omega_, vy_, starts_, past_, cells_, faults_;
  std::array<GpuMemory, 9> outputs_;
  std::vector<std::byte> side_by_side_;  ///< commands that do not lie so
};

}  // namespace slipwise
