// SPDX-License-Identifier: Apache-2.0
// The few things that only a GPU's own libraries can do: memory, copies, and starting a kernel.
#pragma once

#include <cstddef>
#include <string>

#include "slipwise/rollout/gpu/thread_rollout.hpp"

namespace slipwise {

/// Why rollouts cannot run on a GPU here, and what to do about it; empty where they can. The functions below must not
/// be called where it is not empty. They throw std::runtime_error, in the words of the GPU's driver, when they fail.
std::string why_no_gpu();

void* gpu_allocate(std::size_t bytes);
void gpu_free(void* memory) noexcept;

/// Whether a pointer is one of the GPU's memory.
bool lies_on_gpu(const void* pointer);

/// Rows of bytes; pitches are the bytes from one row to the next.
struct GpuCopy {
  void* to;
  std::size_t to_pitch;
  const void* from;
  std::size_t from_pitch;
  std::size_t width;  ///< [bytes] of a row
  std::size_t rows;
};

/// Copies between the GPU's memory and the processor's, either way, and waits until that is done.
void gpu_copy(const GpuCopy& copy);

/// Drives all rollouts of a job and waits for them. `faults` is a number in the GPU's memory.
/// \returns what went wrong in any of them, as bits.
unsigned gpu_roll(const ThreadJob<float>& job, bool wide, unsigned* faults);
unsigned gpu_roll(const ThreadJob<double>& job, bool wide, unsigned* faults);

}  // namespace slipwise
