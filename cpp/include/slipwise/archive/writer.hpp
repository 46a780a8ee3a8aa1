// SPDX-License-Identifier: Apache-2.0
// Values as bytes, little-endian, each kind in one way, so that equal states give equal bytes.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <typeindex>
#include <utility>

#include "slipwise/archive/aggregate.hpp"
#include "slipwise/archive/kinds.hpp"

namespace slipwise::archive {

/// Appends each value that it is called with. An object that several pointers fraction is written once. The values must
/// live as long as the writer.
class Writer {
 public:
  template <class... T>
  void operator()(const T&... values) {
    (write(values), ...);
  }

  const std::string& bytes() const { return bytes_; }

 private:
  template <class T>
  void write(const T& value) {
    if constexpr (std::same_as<T, bool>) {
      write_bits<std::uint8_t>(value ? 1U : 0U);
    } else if constexpr (std::integral<T>) {
      write_bits(static_cast<std::uint64_t>(value));
    } else if constexpr (std::same_as<T, double>) {
      write_bits(std::bit_cast<std::uint64_t>(value));
    } else if constexpr (Counted<T>) {
      write_bits(static_cast<std::uint8_t>(value));
    } else if constexpr (kSequence<T>) {
      write(value.size());
      write_each(value);
    } else if constexpr (kArray<T>) {
      write_each(value);
    } else if constexpr (kOptional<T>) {
      write(value.has_value());
      if (value) {
        write(*value);
      }
    } else if constexpr (kVariant<T>) {
      write(value.index());
      std::visit([this](const auto& held) { write(held); }, value);
    } else if constexpr (kPair<T>) {
      (*this)(value.first, value.second);
    } else if constexpr (kShared<T>) {
      write_shared(value);
    } else if constexpr (Matrix<T>) {
      (*this)(value.rows(), value.cols());
      write_each(value.reshaped());
    } else if constexpr (Defined<T>) {
      std::apply([this](const auto&... parts) { (*this)(parts...); }, value.definition());
    } else if constexpr (Listed<const T, Writer>) {
      T::archive(value, *this);
    } else {
      static_assert(Aggregate<T>, "name the members of the class in archive()");
      with_members(value, [this](const auto&... members) { (*this)(members...); });
    }
  }

  template <class Values>
  void write_each(const Values& values) {
    for (const auto& value : values) {
      if constexpr (std::same_as<std::remove_cvref_t<decltype(value)>, char>) {
        bytes_.push_back(value);
      } else {
        write(value);
      }
    }
  }

  template <class T>
  void write_shared(const std::shared_ptr<const T>& value) {
    if (!value) {
      write(std::size_t{0});
      return;
    }
    const auto [place, added] = shared_.try_emplace({typeid(T), value.get()}, shared_.size() + 1);
    write(place->second);
    if (added) {
      write(*value);
    }
  }

  template <std::unsigned_integral Bits>
  void write_bits(Bits bits) {
    for (std::size_t byte = 0; byte < sizeof(Bits); ++byte) {
      bytes_.push_back(static_cast<char>((static_cast<std::uint64_t>(bits) >> (8U * byte)) & 0xFFU));
    }
  }

  std::string bytes_;
  std::map<std::pair<std::type_index, const void*>, std::size_t> shared_;  ///< their numbers, from 1
};

}  // namespace slipwise::archive
