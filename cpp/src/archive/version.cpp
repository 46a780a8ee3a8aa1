// SPDX-License-Identifier: Apache-2.0
// The version of slipwise, alone: it changes what is compiled here and nothing else.
#include "slipwise/archive/version.hpp"

namespace slipwise::archive {

const char* version() { return SLIPWISE_VERSION; }

}  // namespace slipwise::archive
