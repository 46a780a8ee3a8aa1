// SPDX-License-Identifier: Apache-2.0
// Segments of several sources: never two of the same time, the better one where there is a choice.
#include "slipwise/online/source_merge.hpp"

#include <doctest/doctest.h>

#include <vector>

namespace slipwise {
namespace {

constexpr double kLongest = 2.5;

/// A segment of 1 s that a source with such errors measured.
void come(SourceMerge& merge, std::size_t source, double start, double noise) {
  DrivenSegment driven{.inputs = {}, .segment = {.start = start, .end = start + 1.0}, .known_at = start + 1.0};
  driven.segment.measured.front().sensor.number = source;
  merge.see(source, start, noise);
  merge.push({.driven = driven, .source = source, .noise = noise});
}

std::vector<std::size_t> sources_of(const std::vector<DrivenSegment>& segments) {
  std::vector<std::size_t> found;
  for (const DrivenSegment& each : segments) {
    found.push_back(source_number(each.segment));
  }
  return found;
}

TEST_CASE("the better source wins, whichever comes first, and it waits for nobody") {
  SourceMerge merge(2, kLongest);
  come(merge, 1, 0.0, 10.0);
  CHECK(merge.take(1.0).empty());
  come(merge, 0, 0.2, 1.0);
  CHECK(sources_of(merge.take(1.2)) == std::vector<std::size_t>{0});
  come(merge, 0, 1.2, 1.0);
  CHECK(sources_of(merge.take(2.2)) == std::vector<std::size_t>{0});
  CHECK(merge.waiting().empty());
}

TEST_CASE("the worse source fills a gap once nothing better can come, in the order of time") {
  SourceMerge merge(2, kLongest);
  merge.see(1, -1.0, 10.0);
  come(merge, 0, 0.0, 1.0);
  CHECK(merge.take(1.0).size() == 1);
  for (const double start : {0.5, 1.0, 1.5, 2.0, 2.5}) {
    come(merge, 1, start, 10.0);
  }
  CHECK(merge.take(3.4).empty());
  const auto filled = merge.take(2.0 + kLongest);
  REQUIRE(filled.size() == 1);
  CHECK(filled[0].segment.start == 1.0);
  come(merge, 0, 3.2, 1.0);
  const auto rest = merge.take(4.2);
  REQUIRE(sources_of(rest) == std::vector<std::size_t>{1, 0});
  CHECK(rest[0].segment.start == 2.0);
  CHECK(rest[1].segment.start == 3.2);
}

TEST_CASE("of equal sources the first wins, and all is decided at the end of a run") {
  SourceMerge merge(2, kLongest);
  come(merge, 1, 0.0, 1.0);
  come(merge, 0, 0.0, 1.0);
  come(merge, 1, 1.0, 1.0);
  CHECK(sources_of(merge.finish()) == std::vector<std::size_t>{0, 1});
  merge.restart();
  come(merge, 1, -100.0, 1.0);  // the clock was set again
  CHECK(merge.finish().size() == 1);
}

}  // namespace
}  // namespace slipwise
