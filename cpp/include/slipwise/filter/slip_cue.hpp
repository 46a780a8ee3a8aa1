// SPDX-License-Identifier: Apache-2.0
// What is known of slip beside segments: one kind of it is one type here, and one function of the filter.
#pragma once

#include <variant>

namespace slipwise {

/// Slip parameters get this fraction of their prior variance back and keep their means. Lag, delay and clock are the
/// robot's, not the terrain's: they stay as learned.
struct ForgetSlip {
  double fraction;
};

/// The terrain may have changed just now: slip may have jumped, and where none may jump it is less sure.
struct ChangeExpected {};

/// Slip differs from what is learned for about so long; covariances are stated accordingly.
struct SlipLasts {
  double seconds;  ///< [s]
};

using SlipCue = std::variant<ForgetSlip, ChangeExpected, SlipLasts>;

}  // namespace slipwise
