// SPDX-License-Identifier: Apache-2.0
// An optional value that must be there.
#pragma once

#include <optional>
#include <stdexcept>

namespace slipwise {

/// \throws std::logic_error when there is none.
template <typename T>
T& present(std::optional<T>& value) {
  if (!value) {
    throw std::logic_error("something that is not there was asked for");
  }
  return *value;
}
template <typename T>
const T& present(const std::optional<T>& value) {
  if (!value) {
    throw std::logic_error("something that is not there was asked for");
  }
  return *value;
}

}  // namespace slipwise
