// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/archive: the envelope of saved states.
#include "bindings.hpp"
#include "slipwise/archive/bytes.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {

void bind_archive(nb::module_& m) {
  m.def(
      "sealed", [](const nb::bytes& body) { return bytes_of(archive::sealed(view_of(body))); }, "body"_a,
      "Bytes behind a header and before a checksum.");
  m.def(
      "opened", [](const nb::bytes& blob) { return bytes_of(archive::opened(view_of(blob))); }, "blob"_a,
      "The bytes that were sealed.");
}

}  // namespace slipwise::bindings
