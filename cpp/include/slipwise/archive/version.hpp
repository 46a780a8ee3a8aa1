// SPDX-License-Identifier: Apache-2.0
// The version of slipwise that a saved state is of.
#pragma once

namespace slipwise::archive {

const char* version();

}  // namespace slipwise::archive
