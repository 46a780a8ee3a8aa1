// SPDX-License-Identifier: Apache-2.0
// Bytes that a Writer wrote as values again, whatever the bytes are: never beyond their end, never more than they hold.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <typeindex>
#include <utility>

#include "slipwise/archive/aggregate.hpp"
#include "slipwise/archive/bytes.hpp"
#include "slipwise/archive/kinds.hpp"

namespace slipwise::archive {

/// Of values of which nothing more has to hold than that the bytes have their form.
struct Unchecked {};

/// Reads into each value that it is called with, and lets `Checks` refuse it: `Checks::check(std::type_identity<T>,
/// const T&)` says what has to hold of a struct. A class with private members checks itself where its members are
/// named. \throws std::invalid_argument where the bytes are no such values.
template <class Checks>
class CheckedReader {
 public:
  explicit CheckedReader(std::string_view bytes) : bytes_(bytes) {}

  template <class... T>
  void operator()(T&... values) {
    (read(values), ...);
  }

  std::size_t remaining() const { return bytes_.size(); }
  /// \throws std::invalid_argument if bytes are left.
  void finish() const {
    if (!bytes_.empty()) {
      refuse("longer than its values");
    }
  }

 private:
  template <class T>
  void read(T& value) {
    if constexpr (std::same_as<T, bool>) {
      value = read_below(2, "a truth value") != 0;
    } else if constexpr (std::integral<T>) {
      value = read_integer<T>();
    } else if constexpr (std::same_as<T, double>) {
      value = std::bit_cast<double>(read_bits<std::uint64_t>());
    } else if constexpr (Counted<T>) {
      value = static_cast<T>(read_below(enumerators(T{}), "an enumeration"));
    } else if constexpr (kSequence<T>) {
      read_sequence(value);
    } else if constexpr (kArray<T>) {
      for (auto& element : value) {
        read(element);
      }
    } else if constexpr (kOptional<T>) {
      value.reset();
      if (make<bool>()) {
        value.emplace(make<typename T::value_type>());
      }
    } else if constexpr (kVariant<T>) {
      read_variant(value, std::make_index_sequence<std::variant_size_v<T>>{});
    } else if constexpr (kPair<T>) {
      (*this)(value.first, value.second);
    } else if constexpr (kShared<T>) {
      read_shared(value);
    } else if constexpr (Matrix<T>) {
      read_matrix(value);
    } else if constexpr (Defined<T>) {
      value = make<T>();
    } else if constexpr (Listed<T, CheckedReader>) {
      T::archive(value, *this);
      check(value);
    } else {
      static_assert(Aggregate<T>, "name the members of the class in archive()");
      with_members(value, [this](auto&... members) { (*this)(members...); });
      check(value);
    }
  }

  template <class T>
  static void check(const T& value) {
    if constexpr (requires { Checks::check(std::type_identity<T>{}, value); }) {
      Checks::check(std::type_identity<T>{}, value);
    }
  }

  /// A value of a type that has a constructor without arguments, is rebuilt from its definition, or made of its
  /// members.
  template <class T>
  T make() {
    if constexpr (Defined<T>) {
      auto parts = make_parts(static_cast<decltype(std::declval<const T&>().definition())*>(nullptr));
      return std::make_from_tuple<T>(std::move(parts));
    } else if constexpr (!std::default_initializable<T>) {
      return make_aggregate(static_cast<const Members<T>*>(nullptr), static_cast<T*>(nullptr));
    } else {
      T value{};
      read(value);
      return value;
    }
  }

  template <class... Parts>
  std::tuple<Parts...> make_parts(const std::tuple<Parts...>* /*type*/) {
    return std::tuple<Parts...>{make<Parts>()...};  // braces: from left to right
  }

  template <class... M, Aggregate T>
  T make_aggregate(const std::tuple<M...>* /*members*/, const T* /*type*/) {
    T value{make<M>()...};  // braces: from left to right
    check(value);
    return value;
  }

  template <class T>
  void read_sequence(T& value) {
    const auto count = make<std::size_t>();
    if (count > remaining()) {  // every element takes a byte at least
      refuse("malformed: a list is longer than the bytes");
    }
    value.clear();
    for (std::size_t i = 0; i < count; ++i) {
      if constexpr (std::same_as<typename T::value_type, char>) {
        value.push_back(static_cast<char>(read_bits<std::uint8_t>()));
      } else {
        const std::size_t before = remaining();
        value.push_back(make<typename T::value_type>());
        if (remaining() == before) {
          refuse("malformed: an element without bytes");
        }
      }
    }
  }

  template <class T, std::size_t... I>
  void read_variant(T& value, std::index_sequence<I...> /*places*/) {
    const auto index = make<std::size_t>();
    if (index >= sizeof...(I)) {
      refuse("malformed: an alternative that does not exist");
    }
    ((index == I ? static_cast<void>(value.template emplace<I>(make<std::variant_alternative_t<I, T>>())) : void()),
     ...);
  }

  template <class T>
  void read_shared(std::shared_ptr<const T>& value) {
    const auto number = make<std::size_t>();
    if (number == 0) {
      value.reset();
    } else if (number <= shared_.size()) {
      if (shared_[number - 1].first != typeid(T) || !shared_[number - 1].second) {
        refuse("malformed: a shared object of another type");
      }
      value = std::static_pointer_cast<const T>(shared_[number - 1].second);
    } else if (number == shared_.size() + 1) {
      shared_.emplace_back(typeid(T), nullptr);  // numbered before the objects inside it
      value = std::make_shared<const T>(make<T>());
      shared_[number - 1].second = value;
    } else {
      refuse("malformed: a shared object that does not exist");
    }
  }

  template <Matrix T>
  void read_matrix(T& value) {
    const auto rows = make<Eigen::Index>();
    const auto cols = make<Eigen::Index>();
    if (!fits(rows, T::RowsAtCompileTime) || !fits(cols, T::ColsAtCompileTime)) {
      refuse("malformed: a matrix of another size");
    }
    const auto most = static_cast<Eigen::Index>(remaining() / sizeof(typename T::Scalar));
    if (rows > kMostRows || cols > kMostRows || (cols != 0 && rows > most / cols)) {
      refuse("malformed: a matrix is larger than the bytes");
    }
    value.resize(rows, cols);
    for (auto& element : value.reshaped()) {
      read(element);
    }
  }

  static bool fits(Eigen::Index size, int fixed) { return fixed == Eigen::Dynamic ? size >= 0 : size == fixed; }

  template <std::integral T>
  T read_integer() {
    const auto bits = read_bits<std::uint64_t>();
    const bool fits =
        std::signed_integral<T> ? std::in_range<T>(static_cast<std::int64_t>(bits)) : std::in_range<T>(bits);
    if (!fits) {
      refuse("malformed: a number is out of range");
    }
    return static_cast<T>(bits);
  }

  std::size_t read_below(std::size_t count, std::string_view what) {
    const std::size_t value = read_bits<std::uint8_t>();
    if (value >= count) {
      refuse("malformed: a value that " + std::string(what) + " does not have");
    }
    return value;
  }

  template <std::unsigned_integral Bits>
  Bits read_bits() {
    if (remaining() < sizeof(Bits)) {
      refuse("truncated");
    }
    std::uint64_t bits = 0;
    for (std::size_t byte = 0; byte < sizeof(Bits); ++byte) {
      bits |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes_[byte])) << (8U * byte);
    }
    bytes_.remove_prefix(sizeof(Bits));
    return static_cast<Bits>(bits);
  }

  static constexpr Eigen::Index kMostRows = 1'073'741'824;

  std::string_view bytes_;
  std::vector<std::pair<std::type_index, std::shared_ptr<const void>>> shared_;
};

using Reader = CheckedReader<Unchecked>;

}  // namespace slipwise::archive
