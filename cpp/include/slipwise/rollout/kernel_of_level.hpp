// SPDX-License-Identifier: Apache-2.0
// The kernels of an instruction level.
#pragma once

#include <stdexcept>
#include <string>

#include "slipwise/rollout/instruction_level.hpp"
#include "slipwise/rollout/lane_job.hpp"

namespace slipwise {

/// \throws std::invalid_argument where the processor lacks the level.
inline void check_level(InstructionLevel level) {
  if (!has_instruction_level(level)) {
    throw std::invalid_argument("this processor has no " + std::string(name_of(level)) + "; use " +
                                std::string(name_of(best_instruction_level())));
  }
}

/// \throws std::invalid_argument where the processor lacks the level.
template <typename Scalar>
LaneKernelOfLevel<Scalar> kernel_of(InstructionLevel level) {
  check_level(level);
  LaneKernelOfLevel<Scalar> kernel{};
  if (level == InstructionLevel::Avx512) {
    kernel = avx512_kernel(Scalar{});
  } else if (level == InstructionLevel::Avx2) {
    kernel = avx2_kernel(Scalar{});
  }
  return kernel.roll != nullptr ? kernel : portable_kernel(Scalar{});
}

/// Those of tangents and of futures.
/// \throws std::invalid_argument where the processor lacks the level.
template <typename Scalar>
UncertainKernels<Scalar> uncertain_kernels_of(InstructionLevel level) {
  check_level(level);
  UncertainKernels<Scalar> kernels{};
  if (level == InstructionLevel::Avx512) {
    kernels = avx512_uncertain(Scalar{});
  } else if (level == InstructionLevel::Avx2) {
    kernels = avx2_uncertain(Scalar{});
  }
  return kernels.tangents.roll != nullptr ? kernels : portable_uncertain(Scalar{});
}

}  // namespace slipwise
