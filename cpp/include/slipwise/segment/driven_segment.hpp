// SPDX-License-Identifier: Apache-2.0
// A segment together with the inputs that drove it.
#pragma once

#include "slipwise/actuator/input_history.hpp"
#include "slipwise/segment/segment.hpp"

namespace slipwise {

/// What a segment is learned from: two measured poses, and the inputs that act between them or before.
struct DrivenSegment {
  InputHistory inputs;
  Segment segment;
  double known_at = 0.0;  ///< stamp of the pose with which it became known that this is a segment [s]
};

}  // namespace slipwise
