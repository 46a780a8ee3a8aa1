// SPDX-License-Identifier: Apache-2.0
// Which instructions the rollout kernels may use: chosen when the program runs, by what the processor has.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace slipwise {

/// Portable is what the compiler was asked to build for: any processor that runs the rest of the library. Avx2
/// stands for all of x86-64-v3 (fused multiply-add), Avx512 for x86-64-v4.
enum class InstructionLevel : std::uint8_t { Portable, Avx2, Avx512 };
inline constexpr std::array kInstructionLevels{InstructionLevel::Portable, InstructionLevel::Avx2,
                                               InstructionLevel::Avx512};

std::string_view name_of(InstructionLevel level);
/// Whether this processor has it.
bool has_instruction_level(InstructionLevel level);
InstructionLevel best_instruction_level();

}  // namespace slipwise
