// SPDX-License-Identifier: Apache-2.0
// Hands the newest value from one thread to another without a lock.
#pragma once

#include <atomic>
#include <memory>
#include <utility>

namespace slipwise {

/// One thread puts values, another takes the newest; neither waits. What the taker had before is destroyed by the
/// thread that puts, since a control loop should not.
template <typename T>
class Handoff {
 public:
  Handoff() = default;
  Handoff(const Handoff&) = delete;
  Handoff& operator=(const Handoff&) = delete;
  ~Handoff() {
    const std::unique_ptr<T> newest(newest_.load());
    const std::unique_ptr<T> before(before_.load());
  }

  /// Replaces a value that was not taken yet.
  void put(std::unique_ptr<T> value) {
    const std::unique_ptr<T> missed(newest_.exchange(value.release(), std::memory_order_acq_rel));
    const std::unique_ptr<T> before(before_.exchange(nullptr, std::memory_order_acq_rel));
  }

  /// Puts the newest value in place of `current`; false where there is none since the last time.
  bool take(std::unique_ptr<T>& current) {
    std::unique_ptr<T> newest(newest_.exchange(nullptr, std::memory_order_acq_rel));
    if (newest == nullptr) {
      return false;
    }
    std::swap(current, newest);
    const std::unique_ptr<T> older(before_.exchange(newest.release(), std::memory_order_acq_rel));
    return true;
  }

 private:
  std::atomic<T*> newest_ = nullptr;
  std::atomic<T*> before_ = nullptr;
};

}  // namespace slipwise
