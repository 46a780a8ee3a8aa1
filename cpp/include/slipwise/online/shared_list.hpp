// SPDX-License-Identifier: Apache-2.0
// The last of many things, which copies share.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <type_traits>
#include <utility>

namespace slipwise {

/// The last `kLength` things, oldest first. Copies share them, so that a copy is small however many there are.
template <class T, std::size_t kLength>
class SharedList {
 public:
  static constexpr std::size_t kMost = kLength;

  /// Keeps one; the oldest goes where there are more than `kMost`.
  void keep(std::shared_ptr<const T> one) {
    kept_.push_back(std::move(one));
    if (kept_.size() > kMost) {
      kept_.pop_front();
    }
  }
  std::size_t size() const { return kept_.size(); }
  const T& operator[](std::size_t i) const { return *kept_[i]; }
  const T& back() const { return *kept_.back(); }

  /// Names what is saved: the things, one after the other.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    if constexpr (std::is_const_v<Self>) {
      a(self.kept_.size());
      for (const auto& each : self.kept_) {
        a(*each);
      }
    } else {
      std::deque<T> read;
      a(read);
      self.kept_.clear();
      for (T& each : read) {
        self.kept_.push_back(std::make_shared<const T>(std::move(each)));
      }
    }
  }

 private:
  std::deque<std::shared_ptr<const T>> kept_;
};

}  // namespace slipwise
