// SPDX-License-Identifier: Apache-2.0
// What must be there is, or it is said.
#include "slipwise/linear/present.hpp"

#include <doctest/doctest.h>

#include <utility>

namespace slipwise {
namespace {

TEST_CASE("what is there is handed on, and what is not throws") {
  std::optional<int> value;
  CHECK_THROWS_AS(present(value), std::logic_error);
  value = 3;
  present(value) += 1;
  CHECK(present(std::as_const(value)) == 4);
}

}  // namespace
}  // namespace slipwise
