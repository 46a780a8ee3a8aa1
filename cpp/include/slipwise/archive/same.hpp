// SPDX-License-Identifier: Apache-2.0
// Whether two values would be saved as the same bytes.
#pragma once

#include "slipwise/archive/writer.hpp"

namespace slipwise::archive {

template <class T>
bool same(const T& one, const T& other) {
  Writer first;
  Writer second;
  first(one);
  second(other);
  return first.bytes() == second.bytes();
}

}  // namespace slipwise::archive
