// SPDX-License-Identifier: Apache-2.0
// Which kind of value a type is, for those that write and read it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <concepts>
#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace slipwise::archive {

template <class T>
inline constexpr bool kSequence = false;
template <class T>
inline constexpr bool kSequence<std::vector<T>> = true;
template <class T>
inline constexpr bool kSequence<std::deque<T>> = true;
template <>
inline constexpr bool kSequence<std::string> = true;

template <class T>
inline constexpr bool kArray = false;
template <class T, std::size_t N>
inline constexpr bool kArray<std::array<T, N>> = true;

template <class T>
inline constexpr bool kOptional = false;
template <class T>
inline constexpr bool kOptional<std::optional<T>> = true;

template <class T>
inline constexpr bool kVariant = false;
template <class... T>
inline constexpr bool kVariant<std::variant<T...>> = true;

template <class T>
inline constexpr bool kPair = false;
template <class A, class B>
inline constexpr bool kPair<std::pair<A, B>> = true;

template <class T>
inline constexpr bool kShared = false;
template <class T>
inline constexpr bool kShared<std::shared_ptr<const T>> = true;

template <class T>
concept Matrix = std::derived_from<T, Eigen::PlainObjectBase<T>>;

/// A class that names its members once, `template <class Self, class Archive> static void archive(Self& self,
/// Archive& a) { a(self.first_, self.second_); }`: Self is const where they are written. With a constructor that takes
/// no arguments, or read in place.
template <class T, class Archive>
concept Listed = requires(T& value, Archive& a) { T::archive(value, a); };

/// A class that is written as what defines it, `auto definition() const`, a tuple, and rebuilt by its own constructor
/// from that, so that what the constructor checks is checked.
template <class T>
concept Defined = requires(const T& value) { value.definition(); };

/// An enumeration whose number of values, counted from zero, `constexpr std::size_t enumerators(T)` states beside it.
template <class T>
concept Counted = std::is_enum_v<T> && requires(T value) {
  { enumerators(value) } -> std::same_as<std::size_t>;
};

}  // namespace slipwise::archive
