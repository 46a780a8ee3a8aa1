// SPDX-License-Identifier: Apache-2.0
// What a step of a car hangs on beside its curves.
#pragma once

namespace slipwise {

/// Constants of a car over one step, in the numbers of a kernel.
template <typename Number>
struct CarStep {
  Number cornering_drag;  ///< [s/rad]
  Number understeer;      ///< [s^2/m^2]
  Number steering_left;   ///< of the gap between steering and command, what a step leaves
};

}  // namespace slipwise
