// SPDX-License-Identifier: Apache-2.0
// The model of the residuals of real segments: a Student-t, whose tails are heavier than a normal's.
#pragma once

#include "slipwise/linear/tuning.hpp"

namespace slipwise {

inline SLIPWISE_TUNING(kTailDegrees, 5.0);  ///< degrees of freedom of the Student-t

}  // namespace slipwise
