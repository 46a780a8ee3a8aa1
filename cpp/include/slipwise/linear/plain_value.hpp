// SPDX-License-Identifier: Apache-2.0
// The value alone of a number that may carry derivatives: a plain one is its own value.
#pragma once

namespace slipwise {

inline double value_of(double number) { return number; }

}  // namespace slipwise
