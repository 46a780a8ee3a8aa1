// SPDX-License-Identifier: Apache-2.0
// What a CheckedReader reads in the end, compiled once: never beyond the end of the bytes, never more than they hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <typeindex>
#include <utility>
#include <vector>

namespace slipwise::archive {

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  std::size_t remaining() const { return bytes_.size(); }
  /// \throws std::invalid_argument if bytes are left.
  void finish() const;

 protected:
  std::uint8_t read_8();
  std::uint64_t read_64();
  double read_double();
  std::size_t read_size();
  /// A byte below `count`, the number of values that `what` has.
  std::size_t read_below(std::size_t count, const char* what);
  /// The length of a list: every element takes a byte at least.
  std::size_t read_count();
  std::string read_text();
  void read_doubles(double* values, std::ptrdiff_t count);
  /// Rows and columns of a matrix; `rows` and `cols` are those that its type has, -1 where they are free.
  std::pair<std::ptrdiff_t, std::ptrdiff_t> read_shape(int rows, int cols, std::size_t scalar);
  /// Which alternative of `count` follows.
  std::size_t read_alternative(std::size_t count);
  /// The number of a shared object, 0 for none; one more than there are: its value follows, and share() takes it.
  std::size_t read_object();
  bool is_known(std::size_t number) const { return number <= shared_.size(); }
  void begin_shared(std::type_index type) { shared_.emplace_back(type, nullptr); }
  void share(std::size_t number, std::shared_ptr<const void> object) { shared_[number - 1].second = std::move(object); }
  const std::shared_ptr<const void>& shared(std::size_t number, std::type_index type) const;

 private:
  std::string_view bytes_;
  std::vector<std::pair<std::type_index, std::shared_ptr<const void>>> shared_;
};

}  // namespace slipwise::archive
