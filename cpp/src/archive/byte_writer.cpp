// SPDX-License-Identifier: Apache-2.0
// Numbers, text and shared objects as bytes.
#include "slipwise/archive/byte_writer.hpp"

#include <array>
#include <bit>

namespace slipwise::archive {

void ByteWriter::write_8(std::uint8_t bits) { bytes_.push_back(static_cast<char>(bits)); }

void ByteWriter::write_64(std::uint64_t bits) {
  std::array<char, 8> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<char>((bits >> (8U * i)) & 0xFFU);
  }
  bytes_.append(bytes.data(), bytes.size());
}

void ByteWriter::write_text(std::string_view text) { bytes_ += text; }

void ByteWriter::write_doubles(const double* values, std::ptrdiff_t count) {
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    write_64(std::bit_cast<std::uint64_t>(values[i]));
  }
}

bool ByteWriter::write_object(std::type_index type, const void* object) {
  if (object == nullptr) {
    write_64(0);
    return false;
  }
  const auto [place, added] = shared_.try_emplace({type, object}, shared_.size() + 1);
  write_64(place->second);
  return added;
}

}  // namespace slipwise::archive
