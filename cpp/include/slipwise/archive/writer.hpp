// SPDX-License-Identifier: Apache-2.0
// Values as bytes, little-endian, each kind in one way, so that equal states give equal bytes.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <tuple>
#include <utility>

#include "slipwise/archive/aggregate.hpp"
#include "slipwise/archive/byte_writer.hpp"
#include "slipwise/archive/kinds.hpp"

namespace slipwise::archive {

/// Appends each value that it is called with. An object that several pointers fraction is written once. The values must
/// live as long as the writer.
class Writer : public ByteWriter {
 public:
  template <class... T>
  void operator()(const T&... values) {
    (write(values), ...);
  }

 private:
  template <class T>
  [[gnu::cold]] void write(const T& value) {
    if constexpr (std::same_as<T, bool>) {
      write_8(value ? 1U : 0U);
    } else if constexpr (std::integral<T>) {
      write_64(static_cast<std::uint64_t>(value));
    } else if constexpr (std::same_as<T, double>) {
      write_64(std::bit_cast<std::uint64_t>(value));
    } else if constexpr (Counted<T>) {
      write_8(static_cast<std::uint8_t>(value));
    } else if constexpr (kSequence<T>) {
      write_64(value.size());
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
      if (write_object(typeid(typename T::element_type), value.get())) {
        write(*value);
      }
    } else if constexpr (Matrix<T>) {
      (*this)(value.rows(), value.cols());
      write_elements(value);
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
    if constexpr (std::same_as<Values, std::string>) {
      write_text(values);
    } else {
      for (const auto& value : values) {
        write(value);
      }
    }
  }

  /// Column by column.
  template <Matrix T>
  void write_elements(const T& value) {
    if constexpr (std::same_as<typename T::Scalar, double> && (!T::IsRowMajor || T::IsVectorAtCompileTime)) {
      write_doubles(value.data(), value.size());
    } else {
      write_each(value.reshaped());
    }
  }
};

}  // namespace slipwise::archive
