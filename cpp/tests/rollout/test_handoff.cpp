// SPDX-License-Identifier: Apache-2.0
// Values handed to another thread: the newest one, each destroyed once, never while it is used.
#include "slipwise/rollout/handoff.hpp"

#include <doctest/doctest.h>

#include <thread>

namespace slipwise {
namespace {

TEST_CASE("the newest value replaces the current one, once") {
  Handoff<int> handoff;
  auto current = std::make_unique<int>(0);
  CHECK_FALSE(handoff.take(current));
  handoff.put(std::make_unique<int>(1));
  handoff.put(std::make_unique<int>(2));
  CHECK(handoff.take(current));
  CHECK(*current == 2);
  CHECK_FALSE(handoff.take(current));
  CHECK(*current == 2);
}

TEST_CASE("a taker beside a putter sees values in their order, and the last one") {
  constexpr int kValues = 10'000;
  Handoff<int> handoff;
  std::thread putter([&handoff] {
    for (int i = 1; i <= kValues; ++i) {
      handoff.put(std::make_unique<int>(i));
    }
  });
  std::unique_ptr<int> current;
  int before = 0;
  bool ordered = true;
  while (before < kValues) {
    if (handoff.take(current)) {
      ordered = ordered && *current > before;
      before = *current;
    }
  }
  putter.join();
  CHECK(ordered);
}

}  // namespace
}  // namespace slipwise
