// SPDX-License-Identifier: Apache-2.0
// The envelope of a saved state: what it is, of which version, how long, and a checksum.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace slipwise::archive {

/// CRC-64 (ECMA-182, reflected) of `bytes`.
std::uint64_t checksum(std::string_view bytes);

/// `body` behind a header, which says what it is and of which version of slipwise, and before a checksum of both.
std::string sealed(std::string_view body);

/// The body of what sealed() returned: a view into `blob`. \throws std::invalid_argument that says what is wrong and
/// what to do if it is something else, truncated, altered or of another version.
std::string_view opened(std::string_view blob);

/// \throws std::invalid_argument whose message says that the saved state is `wrong`, and what to do.
[[noreturn]] void refuse(std::string_view wrong);

/// Refuses a state in which something does not hold: `wrong` says what is the case instead.
void require(bool holds, std::string_view wrong);

}  // namespace slipwise::archive
