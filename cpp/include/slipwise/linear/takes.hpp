// SPDX-License-Identifier: Apache-2.0
// Functions of the kinds of a variant.
#pragma once

namespace slipwise {

/// Several functions as one, which takes each kind of a variant by its own.
template <class... Functions>
struct Takes : Functions... {
  using Functions::operator()...;
};

}  // namespace slipwise
