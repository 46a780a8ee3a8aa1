// SPDX-License-Identifier: Apache-2.0
#include "slipwise/archive/aggregate.hpp"

#include <doctest/doctest.h>

#include <array>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "slipwise/archive/reader.hpp"
#include "slipwise/archive/writer.hpp"

using slipwise::archive::Aggregate;
using slipwise::archive::member_count;
using slipwise::archive::Members;
using slipwise::archive::Reader;
using slipwise::archive::with_members;
using slipwise::archive::Writer;

namespace {

struct Inner {
  double first = 0.0;
  int second = 0;
  bool operator==(const Inner&) const = default;
};

struct Outer {
  std::vector<double> numbers;
  std::array<double, 3> three{};
  Inner inner;
  bool flag = false;
  bool operator==(const Outer&) const = default;
};

struct Thirteen {
  int a, b, c, d, e, f, g, h, i, j, k, l, m;
};

struct Fourteen {
  int a, b, c, d, e, f, g, h, i, j, k, l, m, n;
};

class Closed {
 public:
  explicit Closed(int value) : value_(value) {}

 private:
  int value_;
};

}  // namespace

TEST_CASE("members are counted, an array or an aggregate in an aggregate as one") {
  CHECK(member_count<Inner>() == 2);
  CHECK(member_count<Outer>() == 4);
  CHECK(member_count<Thirteen>() == 13);
  CHECK(member_count<Fourteen>() == 14);
}

TEST_CASE("a class that guards its members is no aggregate") { CHECK_FALSE(Aggregate<Closed>); }

TEST_CASE("members are visited in their order") {
  Thirteen value{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13};
  const auto list = [](auto... member) { return std::vector<int>{member...}; };
  CHECK(with_members(value, list) == std::vector<int>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13});
  Fourteen most{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14};
  CHECK(with_members(most, list) == std::vector<int>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14});
  CHECK(std::is_same_v<Members<Inner>, std::tuple<double, int>>);
}

TEST_CASE("an aggregate in an aggregate is written and read") {
  const Outer value{{1.5, -2.0}, {1.0, 2.0, 3.0}, {0.1, -7}, true};
  Writer writer;
  writer(value);
  Outer read;
  Reader reader(writer.bytes());
  reader(read);
  CHECK(read == value);
}
