// SPDX-License-Identifier: Apache-2.0
// Sealing of a blob: what it is, how long, and a checksum.
#include "slipwise/archive/bytes.hpp"

#include <array>
#include <stdexcept>

#include "slipwise/archive/reader.hpp"
#include "slipwise/archive/version.hpp"
#include "slipwise/archive/writer.hpp"

namespace slipwise::archive {
namespace {

constexpr std::string_view kMagic = "slipwise-state\r\n";
constexpr std::size_t kChecksumBytes = 8;

constexpr std::array<std::uint64_t, 256> make_table() {
  std::array<std::uint64_t, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    std::uint64_t value = i;
    for (int bit = 0; bit < 8; ++bit) {
      value = (value >> 1U) ^ ((value & 1U) != 0U ? 0xC96C5795D7870F42U : 0U);
    }
    table[i] = value;
  }
  return table;
}

constexpr std::array<std::uint64_t, 256> kTable = make_table();

}  // namespace

std::uint64_t checksum(std::string_view bytes) {
  std::uint64_t value = ~std::uint64_t{0};
  for (const char byte : bytes) {
    value = kTable[(value ^ static_cast<unsigned char>(byte)) & 0xFFU] ^ (value >> 8U);
  }
  return ~value;
}

std::string sealed(std::string_view body) {
  Writer header;
  header(std::string(version()), static_cast<std::uint64_t>(body.size()));
  std::string blob = std::string(kMagic) + header.bytes();
  blob += body;
  Writer end;
  end(checksum(blob));
  return blob + end.bytes();
}

std::string_view opened(std::string_view blob) {
  if (!blob.starts_with(kMagic.substr(0, blob.size())) || blob.empty()) {
    refuse("no state that slipwise saved");
  }
  if (blob.size() < kMagic.size()) {
    refuse("truncated");
  }
  Reader reader(blob.substr(kMagic.size()));
  std::string saved_by;
  std::uint64_t length = 0;
  reader(saved_by, length);
  if (saved_by != version()) {
    refuse("of slipwise " + saved_by + ", and this is slipwise " + version());
  }
  if (reader.remaining() < kChecksumBytes || length > reader.remaining() - kChecksumBytes) {
    refuse("truncated");
  }
  if (length != reader.remaining() - kChecksumBytes) {
    refuse("longer than it says");
  }
  std::uint64_t expected = 0;
  Reader(blob.substr(blob.size() - kChecksumBytes))(expected);
  if (checksum(blob.substr(0, blob.size() - kChecksumBytes)) != expected) {
    refuse("altered: its checksum differs");
  }
  return blob.substr(blob.size() - kChecksumBytes - length, length);
}

void refuse(std::string_view wrong) {
  throw std::invalid_argument("the saved state is " + std::string(wrong) +
                              "; save it with this version of slipwise and pass all of its bytes unchanged");
}

void require(bool holds, std::string_view wrong) {
  if (!holds) {
    refuse("malformed: " + std::string(wrong));
  }
}

}  // namespace slipwise::archive
