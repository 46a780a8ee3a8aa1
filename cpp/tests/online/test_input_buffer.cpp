// SPDX-License-Identifier: Apache-2.0
// Samples under zero-order hold, in bounded memory.
#include "slipwise/online/input_buffer.hpp"

#include <doctest/doctest.h>

namespace slipwise {
namespace {

InputBuffer sampled(const std::vector<double>& stamps) {
  InputBuffer history(0.5);
  for (const double t : stamps) {
    history.push({t, {t, 0.0, -t}});
  }
  return history;
}

TEST_CASE("an input is held until the next one, and unknown once it is old") {
  const InputBuffer history = sampled({1.0, 1.2, 2.5});
  CHECK_FALSE(history.held_at(0.9).has_value());
  CHECK(history.held_at(1.1).value().v == 1.0);
  CHECK(history.known_at(1.7).value().v == 1.2);
  CHECK_FALSE(history.known_at(1.8).has_value());
  CHECK(history.unknown_since(1.0, 1.7).has_value() == false);
  CHECK(history.unknown_since(1.0, 2.0).value() == doctest::Approx(1.7));
  CHECK(history.unknown_since(0.5, 1.1).value() == 0.5);
  CHECK(history.first_after(1.2).value() == 2.5);
}

TEST_CASE("what is driven is summed where the input is known") {
  const InputBuffer history = sampled({1.0, 1.2, 2.5});
  const InputBuffer::Driven driven = history.driven(1.0, 2.6);
  CHECK(driven.known == doctest::Approx(0.2 + 0.5 + 0.1));
  CHECK(driven.distance == doctest::Approx(1.0 * 0.2 + 1.2 * 0.5 + 2.5 * 0.1));
  CHECK(driven.angle == doctest::Approx(driven.distance));
  CHECK(history.fastest(1.0, 2.5).v == 1.2);
  CHECK(history.fastest_until(2.4).omega == 1.2);
}

TEST_CASE("a wheel speed that is measured stands for the time nearest to its stamp, and the last one for no less") {
  InputBuffer history(0.5);
  for (int i = 0; i < 5; ++i) {
    history.push({0.2 * i, {static_cast<double>(i)}});
  }
  const InputHistory held = history.slice(0.0, 0.7, SliceKind::Wheels);
  const InputHistory measured = history.slice(0.0, 0.7, SliceKind::Measured);
  CHECK(held.at(0.39).v == 1.0);
  CHECK(held.at(0.41).v == 2.0);
  CHECK(measured.at(0.29).v == 1.0);
  CHECK(measured.at(0.31).v == 2.0);
  CHECK(measured.at(0.69).v == 3.0);  // the next one, stamped after the end, is not looked at
}

TEST_CASE("a slice acts as the whole history does, repeats thinned") {
  InputBuffer history(0.5);
  for (int i = 0; i < 300; ++i) {
    history.push({0.01 * i, {i < 150 ? 1.0 : 2.0, 0.0, 0.0}});
  }
  const InputHistory slice = history.slice(0.0, 2.99, SliceKind::Commands);
  CHECK(slice.size() < 40);
  for (const double t : {0.005, 1.4949, 1.5, 2.7}) {
    CHECK(slice.at(t).v == history.held_at(t).value().v);
  }
  CHECK(slice.at(-0.1).v == 0.0);  // before its first command a robot is at rest
  const InputHistory late = history.slice(2.0, 2.5, SliceKind::Commands);
  CHECK(late.at(1.0).v == 2.0);  // what was held for long
  const InputHistory wheels = history.slice(0.0, 0.5, SliceKind::Wheels);
  CHECK(wheels.at(-0.5).v == 1.0);  // wheels may turn before their first sample
}

TEST_CASE("future inputs follow those that came") {
  const InputBuffer history = sampled({1.0, 1.2});
  const InputHistory slice = history.slice(1.0, 3.0, SliceKind::Commands, {{1.1, {9.0}}, {1.5, {5.0}}, {3.5, {7.0}}});
  CHECK(slice.at(1.15).v == 1.0);
  CHECK(slice.at(2.0).v == 5.0);
  CHECK(slice.at(4.0).v == 5.0);
}

TEST_CASE("memory is bounded, and the sample held at the bound stays") {
  InputBuffer history(0.5);
  for (int i = 0; i < 100000; ++i) {
    history.push({0.1 * i, {1.0, 0.0, 0.0}});
    history.drop_before(0.1 * i - 20.0);
    REQUIRE(history.size() < 210);
  }
  CHECK(history.held_at(9979.95).has_value());
  CHECK(history.first() == 0.0);
}

}  // namespace
}  // namespace slipwise
