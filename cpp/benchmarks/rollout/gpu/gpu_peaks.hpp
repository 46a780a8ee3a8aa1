// SPDX-License-Identifier: Apache-2.0
// What a GPU can do at most, measured: copying within its memory, and multiply-adds.
#pragma once

#include <string>

namespace slipwise::benchmarks {

/// Name and architecture of the card.
std::string gpu_name();

/// Bytes per second, read and written, of the fastest of several copies of 256 MiB from memory to memory.
double copy_bandwidth();

/// Fused multiply-adds in float per second, from independent chains in every thread.
double multiply_adds();

}  // namespace slipwise::benchmarks
