// SPDX-License-Identifier: Apache-2.0
// Whether two values would be saved as the same bytes.
#pragma once

#include <array>

#include "slipwise/archive/writer.hpp"

namespace slipwise::archive {

template <class T>
bool same(const T& one, const T& other) {
  std::array<Writer, 2> writers;
  writers[0](one);
  writers[1](other);
  return writers[0].bytes() == writers[1].bytes();
}

}  // namespace slipwise::archive
