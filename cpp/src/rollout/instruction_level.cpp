// SPDX-License-Identifier: Apache-2.0
// Asks the processor, and the operating system, what instructions may be used.
#include "slipwise/rollout/instruction_level.hpp"

namespace slipwise {
namespace {

#if defined(__x86_64__) && defined(__GNUC__)
bool has_avx2() { return __builtin_cpu_supports("x86-64-v3") != 0; }
bool has_avx512() { return __builtin_cpu_supports("x86-64-v4") != 0; }
#else
bool has_avx2() { return false; }
bool has_avx512() { return false; }
#endif

}  // namespace

std::string_view name_of(InstructionLevel level) {
  switch (level) {
    case InstructionLevel::Avx512:
      return "avx512";
    case InstructionLevel::Avx2:
      return "avx2";
    case InstructionLevel::Portable:
      break;
  }
  return "portable";
}

bool has_instruction_level(InstructionLevel level) {
  switch (level) {
    case InstructionLevel::Avx512:
      return has_avx512();
    case InstructionLevel::Avx2:
      return has_avx2();
    case InstructionLevel::Portable:
      break;
  }
  return true;
}

InstructionLevel best_instruction_level() {
  for (const InstructionLevel level : {InstructionLevel::Avx512, InstructionLevel::Avx2}) {
    if (has_instruction_level(level)) {
      return level;
    }
  }
  return InstructionLevel::Portable;
}

}  // namespace slipwise
