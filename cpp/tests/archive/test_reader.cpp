// SPDX-License-Identifier: Apache-2.0
#include "slipwise/archive/reader.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "slipwise/archive/writer.hpp"

using slipwise::archive::Reader;
using slipwise::archive::Writer;

namespace {

enum class Colour : std::uint8_t { Red, Green };
constexpr std::size_t enumerators(Colour /*type*/) { return 2; }

class Even {
 public:
  explicit Even(int value) : value_(value) {
    if (value % 2 != 0) {
      throw std::invalid_argument("odd");
    }
  }
  std::tuple<int> definition() const { return {value_}; }
  bool operator==(const Even&) const = default;

 private:
  int value_;
};

struct All {
  bool yes = false;
  int negative = 0;
  double number = 0.0;
  Colour colour = Colour::Red;
  std::string text;
  std::array<long, 2> pair{};
  std::vector<Even> evens;
  std::deque<double> numbers;
  std::optional<Even> maybe;
  std::variant<double, std::string> either;
  std::pair<bool, double> two;
  Eigen::VectorXd vector;
  Eigen::Matrix<double, 3, Eigen::Dynamic> wide;
  Eigen::Matrix2d fixed = Eigen::Matrix2d::Zero();
  std::shared_ptr<const std::vector<double>> first;
  std::shared_ptr<const std::vector<double>> second;

  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.yes, self.negative, self.number, self.colour, self.text, self.pair, self.evens, self.numbers);
    a(self.maybe, self.either, self.two, self.vector, self.wide, self.fixed, self.first, self.second);
  }
};

All sample() {
  All all;
  all.yes = true;
  all.negative = -7;
  all.number = -std::numeric_limits<double>::infinity();
  all.colour = Colour::Green;
  all.text = std::string("a\0b", 3);
  all.pair = {-1, std::numeric_limits<long>::max()};
  all.evens = {Even(2), Even(-4)};
  all.numbers = {0.1, -0.0};
  all.maybe = Even(6);
  all.either = "word";
  all.two = {true, 2.5};
  all.vector = Eigen::Vector3d(1.0, 2.0, 3.0);
  all.wide = Eigen::Matrix<double, 3, 2>::Random();
  all.fixed << 1.0, 2.0, 3.0, 4.0;
  all.first = std::make_shared<const std::vector<double>>(3, 0.5);
  all.second = all.first;
  return all;
}

std::string bytes_of(const auto& value) {
  Writer writer;
  writer(value);
  return writer.bytes();
}

template <class T>
T read(std::string_view bytes) {
  T value{};
  Reader reader(bytes);
  reader(value);
  reader.finish();
  return value;
}

}  // namespace

TEST_CASE("every kind of value comes back") {
  const All all = sample();
  const All back = read<All>(bytes_of(all));
  CHECK(back.yes);
  CHECK(back.negative == all.negative);
  CHECK(back.number == all.number);
  CHECK(back.colour == all.colour);
  CHECK(back.text == all.text);
  CHECK(back.pair == all.pair);
  CHECK(back.evens == all.evens);
  CHECK(back.numbers == all.numbers);
  CHECK(std::signbit(back.numbers[1]));
  CHECK((back.maybe == all.maybe));
  CHECK((back.either == all.either));
  CHECK((back.two == all.two));
  CHECK(back.vector == all.vector);
  CHECK(back.wide == all.wide);
  CHECK(back.fixed == all.fixed);
  CHECK(*back.first == *all.first);
  CHECK(bytes_of(back) == bytes_of(all));
}

TEST_CASE("an object that pointers fraction is shared again, and no pointer stays none") {
  const All back = read<All>(bytes_of(sample()));
  CHECK(back.first == back.second);
  CHECK(read<All>(bytes_of(All{})).first == nullptr);
}

TEST_CASE("what is read replaces what was there") {
  All all = sample();
  const std::string empty = bytes_of(All{});
  Reader reader(empty);
  reader(all);
  CHECK(bytes_of(all) == empty);
}

TEST_CASE("numbers are little-endian") { CHECK(bytes_of(0x0102) == std::string("\x02\x01\0\0\0\0\0\0", 8)); }

TEST_CASE("truncated at any byte it is refused") {
  const std::string bytes = bytes_of(sample());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    CHECK_THROWS_AS(read<All>(std::string_view(bytes).substr(0, size)), std::invalid_argument);
  }
  CHECK_THROWS_AS(read<All>(bytes + "x"), std::invalid_argument);
}

TEST_CASE("altered bytes are read as other values or refused") {
  const std::string bytes = bytes_of(sample());
  std::mt19937 random(1);  // NOLINT(bugprone-random-generator-seed): the same bytes every time
  int refused = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::string altered = bytes;
    altered[random() % bytes.size()] = static_cast<char>(random() & 0xFFU);
    try {
      read<All>(altered);
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  CHECK(refused > 0);
  CHECK(refused < 20000);
}

TEST_CASE("a count that the bytes cannot hold allocates nothing") {
  const std::size_t huge = std::numeric_limits<std::size_t>::max() / 2;
  CHECK_THROWS_AS(read<std::vector<double>>(bytes_of(huge)), std::invalid_argument);
  CHECK_THROWS_AS(read<Eigen::MatrixXd>(bytes_of(std::array<std::size_t, 2>{huge, huge})), std::invalid_argument);
  CHECK_THROWS_AS(read<Eigen::MatrixXd>(bytes_of(std::array<std::size_t, 2>{huge, 0})), std::invalid_argument);
}

TEST_CASE("values that the types do not have are refused") {
  CHECK_THROWS_AS(read<bool>("\x02"), std::invalid_argument);
  CHECK_THROWS_AS(read<Colour>("\x02"), std::invalid_argument);
  CHECK_THROWS_AS(read<int>(bytes_of(std::numeric_limits<long>::max())), std::invalid_argument);
  CHECK_THROWS_AS(read<std::vector<Even>>(bytes_of(std::vector<int>{3})), std::invalid_argument);
  CHECK_THROWS_AS(read<Eigen::Vector3d>(bytes_of(Eigen::VectorXd::Zero(2).eval())), std::invalid_argument);
  CHECK_THROWS_AS((read<std::variant<bool, int>>(bytes_of(std::size_t{2}))), std::invalid_argument);
  CHECK_THROWS_AS(read<std::shared_ptr<const int>>(bytes_of(std::size_t{2})), std::invalid_argument);
}
