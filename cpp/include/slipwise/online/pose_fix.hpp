// SPDX-License-Identifier: Apache-2.0
// What a satellite receiver says of a position: how it was found. Errors of each sort are a population of their own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace slipwise {

/// In the order in which they become better.
enum class PoseFix : std::uint8_t { Unknown, None, Estimated, Single, Differential, RtkFloat, RtkFixed };
inline constexpr std::size_t kPoseFixes = 7;
constexpr std::size_t enumerators(PoseFix /*type*/) { return kPoseFixes; }

/// A short stable name, such as "rtk_fixed"; nothing of what is unknown.
std::string_view fix_name(PoseFix fix);

/// The number of a source and a fix among all: errors of each are learned apart.
constexpr std::size_t noise_class(std::size_t source, PoseFix fix) {
  return source * kPoseFixes + static_cast<std::size_t>(fix);
}

}  // namespace slipwise
