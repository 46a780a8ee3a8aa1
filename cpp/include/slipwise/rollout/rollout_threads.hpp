// SPDX-License-Identifier: Apache-2.0
// Work that is shared out to threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace slipwise {

/// Calls work(first, last) for as many stretches of [0, count) as there are threads, at the same time. The stretches
/// depend on the numbers alone. One thread: none is started. Throws what the first failing stretch has thrown.
template <typename Work>
void share_out(std::size_t count, unsigned threads, const Work& work) {
  const std::size_t stretches = std::clamp<std::size_t>(threads, 1, std::max<std::size_t>(count, 1));
  if (stretches == 1) {
    work(0, count);
    return;
  }
  std::vector<std::exception_ptr> thrown(stretches);
  const auto run = [&](std::size_t i) {
    try {
      work(count * i / stretches, count * (i + 1) / stretches);
    } catch (...) {
      thrown[i] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t i = 1; i < stretches; ++i) {
      others.emplace_back(run, i);
    }
    run(0);
  }
  for (const std::exception_ptr& exception : thrown) {
    if (exception != nullptr) {
      std::rethrow_exception(exception);
    }
  }
}

}  // namespace slipwise
