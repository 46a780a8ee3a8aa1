// SPDX-License-Identifier: Apache-2.0
// Work on blocks of rollouts, shared out to threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

namespace slipwise {

/// Calls work(first, last) for as many stretches of [0, blocks) as there are threads, at the same time. The
/// stretches depend on the numbers alone. One thread: no thread is started.
template <typename Work>
void share_out(std::size_t blocks, unsigned threads, const Work& work) {
  const std::size_t count = std::clamp<std::size_t>(threads, 1, std::max<std::size_t>(blocks, 1));
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < count; ++i) {
    others.emplace_back([&work, i, blocks, count] { work(blocks * i / count, blocks * (i + 1) / count); });
  }
  work(0, blocks / count);
}

}  // namespace slipwise
