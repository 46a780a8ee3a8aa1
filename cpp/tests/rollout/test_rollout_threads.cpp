// SPDX-License-Identifier: Apache-2.0
// Work that is shared out is done once, all of it, and what fails is thrown where it was asked for.
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <initializer_list>
#include <stdexcept>
#include <thread>
#include <vector>

#include "slipwise/rollout/rollout_threads.hpp"

namespace slipwise {
namespace {

TEST_CASE("every number is worked on exactly once, in stretches of nearly the same length") {
  for (const std::size_t count : {0U, 1U, 3U, 10U, 101U}) {
    for (const unsigned threads : {0U, 1U, 2U, 4U, 7U}) {
      std::vector<int> done(count, 0);
      std::atomic<bool> uneven = false;
      share_out(count, threads, [&](std::size_t first, std::size_t last) {
        if (last - first > count / std::max(threads, 1U) + 1) {
          uneven = true;
        }
        for (std::size_t i = first; i < last; ++i) {
          ++done[i];
        }
      });
      CHECK(done == std::vector<int>(count, 1));
      CHECK_FALSE(uneven);
    }
  }
}

TEST_CASE("one thread works where it was called") {
  std::thread::id worker;
  share_out(5, 1, [&](std::size_t, std::size_t) { worker = std::this_thread::get_id(); });
  CHECK(worker == std::this_thread::get_id());
}

TEST_CASE("the first stretch that fails is what is thrown, after the others are done") {
  std::atomic<int> finished = 0;
  const auto work = [&](std::size_t first, std::size_t) {
    if (first == 2 || first == 6) {
      throw std::runtime_error(first == 2 ? "second" : "fourth");
    }
    ++finished;
  };
  CHECK_THROWS_WITH_AS(share_out(8, 4, work), "second", std::runtime_error);
  CHECK(finished == 2);
}

}  // namespace
}  // namespace slipwise
