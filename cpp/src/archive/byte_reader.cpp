// SPDX-License-Identifier: Apache-2.0
// Numbers, text, sizes and shared objects from bytes.
#include "slipwise/archive/byte_reader.hpp"

#include <bit>

#include "slipwise/archive/bytes.hpp"

namespace slipwise::archive {
namespace {

constexpr std::uint64_t kMostRows = 1'073'741'824;

}  // namespace

void ByteReader::finish() const {
  if (!bytes_.empty()) {
    refuse("longer than its values");
  }
}

std::uint8_t ByteReader::read_8() {
  if (bytes_.empty()) {
    refuse("truncated");
  }
  const auto bits = static_cast<std::uint8_t>(bytes_.front());
  bytes_.remove_prefix(1);
  return bits;
}

std::uint64_t ByteReader::read_64() {
  constexpr std::size_t kBytes = sizeof(std::uint64_t);
  if (bytes_.size() < kBytes) {
    refuse("truncated");
  }
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < kBytes; ++i) {
    bits |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes_[i])) << (8U * i);
  }
  bytes_.remove_prefix(kBytes);
  return bits;
}

double ByteReader::read_double() { return std::bit_cast<double>(read_64()); }

std::size_t ByteReader::read_size() {
  const std::uint64_t bits = read_64();
  if (!std::in_range<std::size_t>(bits)) {
    refuse("malformed: a number is out of range");
  }
  return static_cast<std::size_t>(bits);
}

std::size_t ByteReader::read_below(std::size_t count, const char* what) {
  const std::size_t value = read_8();
  if (value >= count) {
    refuse("malformed: a value that " + std::string(what) + " does not have");
  }
  return value;
}

std::size_t ByteReader::read_count() {
  const std::size_t count = read_size();
  if (count > remaining()) {
    refuse("malformed: a list is longer than the bytes");
  }
  return count;
}

std::string ByteReader::read_text() {
  const std::size_t count = read_count();
  std::string text(bytes_.substr(0, count));
  bytes_.remove_prefix(count);
  return text;
}

void ByteReader::read_doubles(double* values, std::ptrdiff_t count) {
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    values[i] = read_double();
  }
}

std::pair<std::ptrdiff_t, std::ptrdiff_t> ByteReader::read_shape(int rows, int cols, std::size_t scalar) {
  const std::uint64_t high = read_64();
  const std::uint64_t wide = read_64();
  const auto fits = [](std::uint64_t size, int fixed) {
    return fixed < 0 ? std::in_range<std::ptrdiff_t>(size) : std::cmp_equal(size, fixed);
  };
  if (!fits(high, rows) || !fits(wide, cols)) {
    refuse("malformed: a matrix of another size");
  }
  const std::uint64_t most = remaining() / scalar;
  if (high > kMostRows || wide > kMostRows || (wide != 0 && high > most / wide)) {
    refuse("malformed: a matrix is larger than the bytes");
  }
  return {static_cast<std::ptrdiff_t>(high), static_cast<std::ptrdiff_t>(wide)};
}

std::size_t ByteReader::read_alternative(std::size_t count) {
  const std::size_t index = read_size();
  if (index >= count) {
    refuse("malformed: an alternative that does not exist");
  }
  return index;
}

std::size_t ByteReader::read_object() {
  const std::size_t number = read_size();
  if (number > shared_.size() + 1) {
    refuse("malformed: a shared object that does not exist");
  }
  return number;
}

const std::shared_ptr<const void>& ByteReader::shared(std::size_t number, std::type_index type) const {
  const auto& [known, object] = shared_[number - 1];
  if (known != type || !object) {
    refuse("malformed: a shared object of another type");
  }
  return object;
}

}  // namespace slipwise::archive
