// SPDX-License-Identifier: Apache-2.0
// Bytes that a Writer wrote as values again, whatever the bytes are: never beyond their end, never more than they hold.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "slipwise/archive/aggregate.hpp"
#include "slipwise/archive/byte_reader.hpp"
#include "slipwise/archive/bytes.hpp"
#include "slipwise/archive/kinds.hpp"

namespace slipwise::archive {

/// Of values of which nothing more has to hold than that the bytes have their form.
struct Unchecked {};

/// Reads into each value that it is called with, and lets `Checks` refuse it: `Checks::check(std::type_identity<T>,
/// const T&)` says what has to hold of a struct. A class with private members checks itself where its members are
/// named. \throws std::invalid_argument where the bytes are no such values.
template <class Checks>
class CheckedReader : public ByteReader {
 public:
  using ByteReader::ByteReader;

  template <class... T>
  void operator()(T&... values) {
    (read(values), ...);
  }

 private:
  template <class T>
  [[gnu::cold]] void read(T& value) {
    if constexpr (std::same_as<T, bool>) {
      value = read_below(2, "a truth value") != 0;
    } else if constexpr (std::integral<T>) {
      value = read_integer<T>();
    } else if constexpr (std::same_as<T, double>) {
      value = read_double();
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
  [[gnu::cold]] T make() {
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
    if constexpr (std::same_as<T, std::string>) {
      value = read_text();
    } else {
      const std::size_t count = read_count();
      value.clear();
      for (std::size_t i = 0; i < count; ++i) {
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
    const std::size_t index = read_alternative(sizeof...(I));
    ((index == I ? static_cast<void>(value.template emplace<I>(make<std::variant_alternative_t<I, T>>())) : void()),
     ...);
  }

  template <class T>
  void read_shared(std::shared_ptr<const T>& value) {
    const std::size_t number = read_object();
    if (number == 0) {
      value.reset();
    } else if (is_known(number)) {
      value = std::static_pointer_cast<const T>(shared(number, typeid(T)));
    } else {
      begin_shared(typeid(T));  // numbered before the objects inside it
      value = std::make_shared<const T>(make<T>());
      share(number, value);
    }
  }

  /// Column by column.
  template <Matrix T>
  void read_matrix(T& value) {
    const auto [rows, cols] = read_shape(T::RowsAtCompileTime, T::ColsAtCompileTime, sizeof(typename T::Scalar));
    if (!fits(rows, T::MaxRowsAtCompileTime) || !fits(cols, T::MaxColsAtCompileTime)) {
      refuse("malformed: a matrix is too large");
    }
    value.resize(rows, cols);
    if constexpr (std::same_as<typename T::Scalar, double> && (!T::IsRowMajor || T::IsVectorAtCompileTime)) {
      read_doubles(value.data(), value.size());
    } else {
      for (auto& element : value.reshaped()) {
        read(element);
      }
    }
  }

  static bool fits(Eigen::Index size, int most) { return most == Eigen::Dynamic || size <= most; }

  template <std::integral T>
  T read_integer() {
    const std::uint64_t bits = read_64();
    const bool in_range =
        std::signed_integral<T> ? std::in_range<T>(static_cast<std::int64_t>(bits)) : std::in_range<T>(bits);
    if (!in_range) {
      refuse("malformed: a number is out of range");
    }
    return static_cast<T>(bits);
  }
};

using Reader = CheckedReader<Unchecked>;

}  // namespace slipwise::archive
