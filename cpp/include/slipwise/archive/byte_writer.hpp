// SPDX-License-Identifier: Apache-2.0
// What a Writer appends in the end, compiled once: numbers, text and shared objects as bytes, little-endian.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <typeindex>
#include <utility>

namespace slipwise::archive {

class ByteWriter {
 public:
  const std::string& bytes() const { return bytes_; }

 protected:
  void write_8(std::uint8_t bits);
  void write_64(std::uint64_t bits);
  void write_text(std::string_view text);
  void write_doubles(const double* values, std::ptrdiff_t count);
  /// Writes which object this is; returns whether its value has to follow, as it was not written before.
  bool write_object(std::type_index type, const void* object);

 private:
  std::string bytes_;
  std::map<std::pair<std::type_index, const void*>, std::uint64_t> shared_;  ///< their numbers, from 1
};

}  // namespace slipwise::archive
