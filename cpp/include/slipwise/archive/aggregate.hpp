// SPDX-License-Identifier: Apache-2.0
// The members of a plain struct one by one: what has no invariant needs no list of what is saved.
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

namespace slipwise::archive {

/// A struct whose members are all public.
template <class T>
concept Aggregate = std::is_class_v<T> && std::is_aggregate_v<T>;

/// Stands for a value of any type where it is only asked whether there is place for one.
struct Anything {
  template <class T>
  operator T() const;  // NOLINT(google-explicit-constructor, hicpp-explicit-conversions)
};

template <class T, std::size_t... I>
consteval bool takes(std::index_sequence<I...> /*members*/) {
  return requires { T{(static_cast<void>(I), Anything{})...}; };
}

/// How many members an aggregate has: as many as it can be made of, of at most `kMost`.
template <Aggregate T, std::size_t kMost = 15>
consteval std::size_t member_count() {
  if constexpr (takes<T>(std::make_index_sequence<kMost>{})) {
    return kMost;
  } else {
    return member_count<T, kMost - 1>();
  }
}

/// Calls `use` with the members of an aggregate of up to fourteen, in their order.
template <class T, class Use>
auto with_members(T& value, const Use& use) {
  constexpr std::size_t kCount = member_count<std::remove_const_t<T>>();
  static_assert(kCount > 0 && kCount < 15, "an aggregate of one to fourteen members");
  // clang-format off
  if constexpr (kCount == 1) { auto& [a] = value; return use(a); }
  else if constexpr (kCount == 2) { auto& [a, b] = value; return use(a, b); }
  else if constexpr (kCount == 3) { auto& [a, b, c] = value; return use(a, b, c); }
  else if constexpr (kCount == 4) { auto& [a, b, c, d] = value; return use(a, b, c, d); }
  else if constexpr (kCount == 5) { auto& [a, b, c, d, e] = value; return use(a, b, c, d, e); }
  else if constexpr (kCount == 6) { auto& [a, b, c, d, e, f] = value; return use(a, b, c, d, e, f); }
  else if constexpr (kCount == 7) { auto& [a, b, c, d, e, f, g] = value; return use(a, b, c, d, e, f, g); }
  else if constexpr (kCount == 8) { auto& [a, b, c, d, e, f, g, h] = value; return use(a, b, c, d, e, f, g, h); }
  else if constexpr (kCount == 9) { auto& [a, b, c, d, e, f, g, h, i] = value; return use(a, b, c, d, e, f, g, h, i); }
  else if constexpr (kCount == 10) {
    auto& [a, b, c, d, e, f, g, h, i, j] = value; return use(a, b, c, d, e, f, g, h, i, j);
  } else if constexpr (kCount == 11) {
    auto& [a, b, c, d, e, f, g, h, i, j, k] = value; return use(a, b, c, d, e, f, g, h, i, j, k);
  } else if constexpr (kCount == 12) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l] = value; return use(a, b, c, d, e, f, g, h, i, j, k, l);
  } else if constexpr (kCount == 13) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = value; return use(a, b, c, d, e, f, g, h, i, j, k, l, m);
  } else {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = value; return use(a, b, c, d, e, f, g, h, i, j, k, l, m, n);
  }
  // clang-format on
}

template <Aggregate T>
auto members_type(T& value) {
  return with_members(value, []<class... M>(M&... /*members*/) { return std::type_identity<std::tuple<M...>>{}; });
}

/// Their types, as a tuple.
template <Aggregate T>
using Members = decltype(members_type(std::declval<T&>()))::type;

}  // namespace slipwise::archive
