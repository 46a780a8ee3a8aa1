// SPDX-License-Identifier: Apache-2.0
// Every reason has a name and words of its own.
#include <doctest/doctest.h>

#include <set>
#include <string_view>

#include "slipwise/online/rejection.hpp"

namespace slipwise {

TEST_CASE("reasons have names without spaces, and words, each its own") {
  std::set<std::string_view> names;
  std::set<std::string_view> texts;
  for (std::size_t i = 0; i < kReasons; ++i) {
    const std::string_view name = reason_name(static_cast<Reason>(i));
    CHECK(!name.empty());
    CHECK(name.find(' ') == std::string_view::npos);
    CHECK(reason_text(static_cast<Reason>(i)).size() > name.size() / 2);
    names.insert(name);
    texts.insert(reason_text(static_cast<Reason>(i)));
  }
  CHECK(names.size() == kReasons);
  CHECK(texts.size() == kReasons);
  CHECK(reason_name(Reason::DuplicateStamp) == "duplicate-stamp");
}

}  // namespace slipwise
