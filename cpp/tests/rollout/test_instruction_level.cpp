// SPDX-License-Identifier: Apache-2.0
// The level that is chosen is the highest that this processor has, and every level has a name of its own.
#include <doctest/doctest.h>

#include <set>
#include <string_view>

#include "slipwise/rollout/instruction_level.hpp"

namespace slipwise {
namespace {

TEST_CASE("the best level is one that this processor has, and none above it is") {
  const InstructionLevel best = best_instruction_level();
  CHECK(has_instruction_level(best));
  CHECK(has_instruction_level(InstructionLevel::Portable));
  for (const InstructionLevel level : kInstructionLevels) {
    CHECK((level <= best || !has_instruction_level(level)));
  }
}

TEST_CASE("a processor that has a level has those below it") {
  CHECK((has_instruction_level(InstructionLevel::Avx2) || !has_instruction_level(InstructionLevel::Avx512)));
}

TEST_CASE("the names are those that settings use") {
  std::set<std::string_view> names;
  for (const InstructionLevel level : kInstructionLevels) {
    names.insert(name_of(level));
  }
  CHECK(names == std::set<std::string_view>{"portable", "avx2", "avx512"});
  CHECK(name_of(InstructionLevel::Portable) == "portable");
}

}  // namespace
}  // namespace slipwise
