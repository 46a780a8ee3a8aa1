// SPDX-License-Identifier: Apache-2.0
#include "slipwise/archive/bytes.hpp"

#include <doctest/doctest.h>

#include <stdexcept>
#include <string>

#include "slipwise/archive/writer.hpp"

using slipwise::archive::checksum;
using slipwise::archive::opened;
using slipwise::archive::sealed;

TEST_CASE("the checksum is CRC-64/XZ") { CHECK(checksum("123456789") == 0x995DC9BBDF1939FAU); }

TEST_CASE("what was sealed is opened") {
  CHECK(opened(sealed("")).empty());
  CHECK(opened(sealed("a body")) == "a body");
}

TEST_CASE("truncated at any byte, or longer, it is refused") {
  const std::string blob = sealed("a body");
  for (std::size_t size = 0; size < blob.size(); ++size) {
    CHECK_THROWS_AS(opened(std::string_view(blob).substr(0, size)), std::invalid_argument);
  }
  CHECK_THROWS_AS(opened(blob + "x"), std::invalid_argument);
}

TEST_CASE("any altered bit is refused") {
  const std::string blob = sealed("a body");
  for (std::size_t bit = 0; bit < 8 * blob.size(); ++bit) {
    std::string altered = blob;
    altered[bit / 8] = static_cast<char>(static_cast<unsigned char>(altered[bit / 8]) ^ (1U << (bit % 8)));
    CHECK_THROWS_AS(opened(altered), std::invalid_argument);
  }
}

TEST_CASE("the message says what is wrong and what to do") {
  CHECK_THROWS_WITH_AS(
      opened("PK"),
      "the saved state is no state that slipwise saved; save it with this version of slipwise and pass "
      "all of its bytes unchanged",
      std::invalid_argument);
}

TEST_CASE("the state of another version is refused") {
  std::string blob = sealed("a body");
  const std::size_t version = blob.find('.');  // its first letter but one
  blob.replace(version, 1, "x");
  blob.resize(blob.size() - 8);
  slipwise::archive::Writer end;
  end(checksum(blob));
  CHECK_THROWS_WITH_AS(opened(blob + end.bytes()), doctest::Contains("is of slipwise 0x"), std::invalid_argument);
}
